//! Named scenes that questions are measured on: generated from a seed, or made of a user's own meshes.
//!
//! # Method
//! A scene says which forms lie where, and what usually asks there. The same name and seed give the same scene.
//!
//! | name | holds | what it is hard for |
//! |---|---|---|
//! | `arena` | walls, crates, ramps, pillars, many players | nothing: what most games ask |
//! | `debris` | concave rocks, hulls of few and of many points, in free space | large geometries |
//! | `terrain` | a height field with boulders and trees | one shape that everything is near |
//! | `columns` | fluted columns, meshes of their own | concave things in rows |
//! | `needles` | thin boxes, cones and rods, 100 to 1,000 times as long as wide | aspect |
//! | `planet` | small things on a ball of 6,371 km, far from the origin | digits |
//! | `coins` | a heap of discs, round ones and ones of 512 corners | flat contacts |

mod assets;
mod bodies;
mod places;
mod things;

use std::{num::NonZeroU64, sync::Arc};

use collision::{
    DVec3,
    math::{Aabb, Pose},
    shape::{Form, Geometry, GeometryError},
    world::{Edit, EditRule, Means, Mobility, Settings, Shape, ShapeId, Snapshot, Time, World},
};

use crate::scene::Random;

/// Forms of a user's world that are asked about.
const SUBJECTS_MAX: usize = 4;

/// The names of the scenes that are generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// Walls, crates, ramps, pillars and players.
    Arena,
    /// Rocks in free space.
    Debris,
    /// A height field with things on it.
    Terrain,
    /// A hall of fluted columns.
    Columns,
    /// A forest of needles.
    Needles,
    /// Things on a ball as large as the Earth.
    Planet,
    /// A heap of coins.
    Coins,
}

impl Name {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Arena, Self::Debris, Self::Terrain, Self::Columns, Self::Needles, Self::Planet, Self::Coins];

    /// As it is written.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Arena => "arena",
            Self::Debris => "debris",
            Self::Terrain => "terrain",
            Self::Columns => "columns",
            Self::Needles => "needles",
            Self::Planet => "planet",
            Self::Coins => "coins",
        }
    }
}

impl std::str::FromStr for Name {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = || Self::ALL.map(Self::text).join(", ");
        Self::ALL.into_iter().find(|name| name.text() == text).ok_or_else(|| format!("the scenes are {}", known()))
    }
}

/// A form that lies in a scene.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its form; the same one for all that are alike.
    pub geometry: Arc<Geometry>,
    /// Where it is.
    pub pose: Pose,
    /// Whether it moves.
    pub mobility: Mobility,
}

/// What lies where, and what asks there.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name, or that of its file.
    pub name: String,
    /// What lies in it; the id of each is its number from 1.
    pub items: Vec<Item>,
    /// Forms that questions are about.
    pub subjects: Vec<Arc<Geometry>>,
    /// How large those are, metres.
    pub size: f64,
}

/// Triangles of a user's file, in metres.
#[derive(Clone, Debug)]
pub struct Triangles {
    /// The name of the file.
    pub name: String,
    /// Corners.
    pub vertices: Vec<DVec3>,
    /// Three of them for each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// What a file is taken for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TakenFor {
    /// Its triangles.
    #[default]
    Mesh,
    /// The convex hull of its corners.
    Hull,
}

impl Scene {
    /// A generated scene.
    #[must_use]
    pub fn named(name: Name, seed: u64) -> Self {
        let random = &mut Random::new(seed);
        let made = match name {
            Name::Arena => places::arena(random),
            Name::Debris => places::debris(random),
            Name::Terrain => places::terrain(random),
            Name::Columns => places::columns(random),
            Name::Needles => things::needles(random),
            Name::Planet => things::planet(random),
            Name::Coins => things::coins(random),
        };
        made.unwrap_or_else(|error| unreachable!("{}, seed {seed}: {error}", name.text()))
    }

    /// The first file stands; the others, or without any a ball, a capsule and a box a thirtieth as large, are asked about.
    ///
    /// # Errors
    /// The triangles are no mesh, or out of limits; there are none.
    pub fn of_files(files: &[Triangles], taken_for: TakenFor) -> Result<Self, GeometryError> {
        let made = |file: &Triangles| match taken_for {
            TakenFor::Mesh => Geometry::mesh(&file.vertices, &file.triangles).map(Arc::new),
            TakenFor::Hull => Geometry::hull(&file.vertices).map(Arc::new),
        };
        let geometries: Vec<Arc<Geometry>> = files.iter().map(made).collect::<Result<_, _>>()?;
        let Some((level, subjects)) = geometries.split_first() else {
            return Err(GeometryError::Bad { field: "files".into(), reason: "there is none".into() });
        };
        let extent = level.local_bounds().max - level.local_bounds().min;
        let (subjects, size) = match subjects {
            [] => (bodies::usual(extent.length() / 60.0)?, extent.length() / 30.0),
            given => (given.to_vec(), given.iter().map(|form| form.reach()).fold(0.0, f64::max)),
        };
        let level = Item { geometry: level.clone(), pose: Pose::IDENTITY, mobility: Mobility::Static };
        let name = files.iter().map(|file| file.name.as_str()).collect::<Vec<_>>().join(" and ");
        Ok(Self { name, items: vec![level], subjects, size })
    }

    /// A version of a user's world. What moves in it is asked about, up to some forms in the order of ids; where nothing does, a ball, a
    /// capsule and a box of half the usual size. Filters and velocities are left out, and ids are numbers from 1.
    ///
    /// # Errors
    /// There is no shape, or only half spaces.
    pub fn of_world(name: &str, world: &Snapshot) -> Result<Self, GeometryError> {
        let item =
            |shape: &Shape| Item { geometry: shape.geometry.clone(), pose: shape.pose, mobility: shape.mobility };
        let items: Vec<Item> = world.shapes_after(None, usize::MAX, None).into_iter().map(item).collect();
        let is_bounded = |item: &&Item| !matches!(item.geometry.form(), Form::HalfSpace(_));
        let mut sizes: Vec<f64> = items.iter().filter(is_bounded).map(|item| item.geometry.reach()).collect();
        sizes.sort_by(f64::total_cmp);
        let Some(&usual) = sizes.get(sizes.len() / 2) else {
            return Err(GeometryError::Bad { field: "shapes".into(), reason: "there is none to ask about".into() });
        };
        let mut subjects: Vec<Arc<Geometry>> = Vec::new();
        for Item { geometry, .. } in items.iter().filter(is_bounded).filter(|item| item.mobility != Mobility::Static) {
            if subjects.len() < SUBJECTS_MAX && subjects.iter().all(|known| known.id() != geometry.id()) {
                subjects.push(geometry.clone());
            }
        }
        if subjects.is_empty() {
            subjects = bodies::usual(0.5 * usual)?;
        }
        let size = subjects.iter().map(|form| form.reach()).fold(0.0, f64::max);
        Ok(Self { name: name.to_owned(), items, subjects, size })
    }

    /// The id of an item.
    ///
    /// # Panics
    /// Never: ids begin at 1.
    #[must_use]
    pub fn id(index: usize) -> ShapeId {
        NonZeroU64::new(index as u64 + 1).expect("it is one more than a number")
    }

    /// The item of an id.
    #[must_use]
    pub fn item(&self, id: ShapeId) -> Option<&Item> {
        self.items.get(usize::try_from(id.get() - 1).ok()?)
    }

    /// A world with everything in it.
    #[must_use]
    pub fn world(&self) -> World {
        self.world_with(Settings::default(), Means::default())
    }

    /// The same with settings and means.
    ///
    /// # Panics
    /// Never: nothing is moved that is not there.
    #[must_use]
    pub fn world_with(&self, settings: Settings, means: Means) -> World {
        let mut world = World::with(Time(0), settings, means);
        let shapes = self.items.iter().enumerate().map(|(index, item)| {
            let shape = Shape::new(Self::id(index), item.geometry.clone(), item.pose);
            Edit::Insert(Shape { mobility: item.mobility, ..shape })
        });
        world.apply(shapes.collect(), Time(0), EditRule::AllOrNothing).expect("only insertions");
        world
    }

    /// The box of all items.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let boxes = self.items.iter().map(|item| item.geometry.bounds(&item.pose));
        boxes.reduce(Aabb::union).unwrap_or(Aabb::new(DVec3::ZERO, DVec3::ZERO))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_names_a_scene() {
        for name in Name::ALL {
            let told = |seed| {
                let scene = Scene::named(name, seed);
                scene.items.iter().map(|item| (item.geometry.id(), item.pose)).collect::<Vec<_>>()
            };
            assert_eq!(told(3), told(3), "{}", name.text());
            assert_ne!(told(3), told(4), "{}", name.text());
            assert_eq!(name.text().parse(), Ok(name));
        }
    }

    #[test]
    fn scenes_have_what_they_are_named_for() {
        let needles = Scene::named(Name::Needles, 1);
        let thin = |item: &Item| {
            let size = item.geometry.local_bounds().max - item.geometry.local_bounds().min;
            size.max_element() >= 99.0 * size.min_element()
        };
        assert!(needles.items.iter().all(thin));
        let planet = Scene::named(Name::Planet, 1);
        let far = planet.items.iter().filter(|item| item.pose.position.length() > 6e6).count();
        assert!(far >= 300 && far + 1 == planet.items.len());
        let of_many = |item: &Item| item.geometry.stand_in(collision::answer::Representation::SimplifiedHull).is_some();
        for name in [Name::Debris, Name::Columns, Name::Coins] {
            assert!(Scene::named(name, 1).items.iter().any(of_many), "{}", name.text());
        }
    }

    #[test]
    fn of_a_world_what_moves_is_asked_about() {
        let arena = Scene::named(Name::Arena, 1);
        let scene = Scene::of_world("mine", &arena.world().newest()).expect("it has shapes");
        let told = |scene: &Scene| scene.items.iter().map(|item| (item.geometry.id(), item.pose)).collect::<Vec<_>>();
        assert_eq!(told(&scene), told(&arena));
        assert_eq!(scene.subjects.len(), SUBJECTS_MAX);
        let still = arena.items.iter().map(|item| Item { mobility: Mobility::Static, ..item.clone() }).collect();
        let still = Scene { items: still, ..arena };
        assert_eq!(Scene::of_world("still", &still.world().newest()).expect("it has shapes").subjects.len(), 3);
        let nothing = Scene { items: Vec::new(), ..still };
        assert!(Scene::of_world("nothing", &nothing.world().newest()).is_err());
    }

    #[test]
    fn a_file_alone_is_asked_about_by_forms_of_its_size() {
        let vertices = vec![DVec3::ZERO, DVec3::X * 30.0, DVec3::Y * 30.0, DVec3::Z * 30.0];
        let file =
            Triangles { name: "a".into(), vertices, triangles: vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]] };
        let alone = Scene::of_files(std::slice::from_ref(&file), TakenFor::Mesh).expect("it is a mesh");
        assert_eq!((alone.items.len(), alone.subjects.len()), (1, 3));
        let itself = Scene::of_files(&[file.clone(), file], TakenFor::Hull).expect("it is a hull");
        assert_eq!((itself.subjects.len(), itself.name.as_str()), (1, "a and a"));
        assert!(Scene::of_files(&[], TakenFor::Mesh).is_err());
    }
}
