//! What a scene had built because it was asked, beside everything that can be built.

use std::hint::black_box;

use collision::{
    accuracy::{Accuracy, Tier},
    answer::Representation,
    shape::{Convex, Core, Form, Geometry, distinct},
    world::{BuiltStructure, Description, Snapshot},
};

use super::{
    Kind,
    ask::ask,
    clock::clock,
    questions::{Question, questions},
};
use crate::scenes::Scene;

/// What was built for some questions.
#[derive(Clone, Debug)]
pub struct Needed {
    /// For which questions.
    pub asked: String,
    /// What the world holds then.
    pub description: Description,
    /// What building it took, milliseconds: what the first time of all questions took longer than the second.
    pub build_ms: f64,
}

impl Needed {
    /// What was built, by name.
    pub fn built(&self) -> impl Iterator<Item = &BuiltStructure> {
        self.description.built.iter()
    }
}

/// What each kind of question, all of them, and none at all have built; at last everything that can be. `scene` makes the scene anew,
/// as forms keep what was built of them.
#[must_use]
pub fn needed(scene: &dyn Fn() -> Scene, count: usize, seed: u64) -> Vec<Needed> {
    let mut all = vec![of_questions(scene, "nothing", &[], Tier::Exact, (0, seed))];
    for kind in Kind::ALL {
        all.push(of_questions(scene, kind.text(), &[kind], Tier::Exact, (count, seed)));
    }
    all.push(of_questions(scene, "all, EXACT", &Kind::ALL, Tier::Exact, (count, seed)));
    all.push(of_questions(scene, "all, FAST", &Kind::ALL, Tier::Fast, (count, seed)));
    all.push(everything(&scene()));
    all
}

fn of_questions(make: &dyn Fn() -> Scene, asked: &str, kinds: &[Kind], tier: Tier, drawn: (usize, u64)) -> Needed {
    let scene = make();
    let snapshot = scene.world().newest();
    let all: Vec<Question> = kinds.iter().flat_map(|&kind| questions(&make(), kind, drawn.0, drawn.1)).collect();
    let pass = || {
        let begin = clock();
        all.iter().for_each(|question| drop(ask(&snapshot, question, &Accuracy::of(tier))));
        (clock() - begin).as_secs_f64() * 1e3
    };
    let (first, second) = (pass(), pass());
    Needed { asked: asked.to_owned(), description: snapshot.describe(), build_ms: (first - second).max(0.0) }
}

/// Everything but convex parts, which no question makes.
fn everything(scene: &Scene) -> Needed {
    let snapshot = scene.world().newest();
    let begin = clock();
    for geometry in distinct(scene.items.iter().map(|item| &item.geometry)) {
        build(geometry);
    }
    build_tree(&snapshot, scene);
    let build_ms = (clock() - begin).as_secs_f64() * 1e3;
    Needed { asked: "everything".to_owned(), description: snapshot.describe(), build_ms }
}

fn build(geometry: &Geometry) {
    for rung in [Representation::Ball, Representation::OrientedBox, Representation::SimplifiedHull] {
        black_box(geometry.stand_in(rung));
    }
    match geometry.form() {
        Form::Mesh(mesh) => {
            black_box((mesh.tree(), mesh.report()));
        }
        Form::Compound(compound) => {
            black_box(compound.tree());
        }
        Form::Convex(Convex { core: Core::Hull(hull), .. }) => {
            black_box(hull.topology());
        }
        Form::Convex(_) | Form::HeightField(_) | Form::HalfSpace(_) => {}
    }
}

/// The static tree and pyramids of heights are built by whoever asks first.
fn build_tree(snapshot: &Snapshot, scene: &Scene) {
    for question in questions(scene, Kind::Distance, 8, 1) {
        drop(ask(snapshot, &question, &Accuracy::of(Tier::Exact)));
    }
}
