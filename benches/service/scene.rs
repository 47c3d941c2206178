//! The world that is asked, and the rays: the same for the server and for the library alone.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::{Duration, Instant};

use calipers_client::{Client, EditWriter, ask, proto, shape};
use collision::{
    DQuat, DVec3,
    accuracy::Accuracy,
    math::Pose,
    narrow::{Faces, Ray},
    shape::Geometry,
    world::{Edit, EditRule, Filter, HitMode, Meter, Raycast, Shape, ShapeId, Snapshot, Time, World},
};
use rustix::time::{ClockId, clock_gettime};

use crate::Failure;
use crate::dice::Dice;

/// Volume of a sphere of radius 1.
const SPHERE: f64 = 2.0 * TAU / 3.0;
/// Shapes of a message.
const MESSAGE: usize = 5_000;
pub(crate) const RAY_LENGTH: f64 = 10.0;

#[derive(Clone, Copy, Debug)]
enum Form {
    Box([f64; 3]),
    Sphere(f64),
    Capsule { half_height: f64, radius: f64 },
}

#[derive(Clone, Copy, Debug)]
struct Item {
    id: u64,
    form: Form,
    position: [f64; 3],
    rotation: [f64; 4],
}

/// Half boxes, a quarter spheres, a quarter capsules, 0.2 to 2 m, in a cube of which they fill about 5 %.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    items: Vec<Item>,
    /// Of the cube, metres.
    pub(crate) side: f64,
}

impl Scene {
    pub(crate) fn new(count: u64, dice: &mut Dice) -> Self {
        let mut volume = 0.0;
        let forms: Vec<Form> = (1..=count)
            .map(|id| {
                let mut half = || dice.between(0.1, 1.0);
                let (form, size) = match id % 4 {
                    0 | 1 => {
                        let [x, y, z] = [half(), half(), half()];
                        (Form::Box([x, y, z]), 8.0 * x * y * z)
                    }
                    2 => {
                        let radius = half();
                        (Form::Sphere(radius), SPHERE * radius.powi(3))
                    }
                    _ => {
                        let (radius, half_height) = (0.5 * half(), half() - 0.09);
                        let size = (TAU * half_height + SPHERE * radius) * radius.powi(2);
                        (Form::Capsule { half_height, radius }, size)
                    }
                };
                volume += size;
                form
            })
            .collect();
        let side = (volume / 0.05).cbrt();
        let item = |(form, id)| {
            let rotation = std::array::from_fn(|_| dice.between(-1.0, 1.0));
            Item { id, form, position: dice.point(side), rotation }
        };
        Self { items: forms.into_iter().zip(1..).map(item).collect(), side }
    }

    /// Where the shapes are, by id.
    pub(crate) fn places(&self) -> impl Iterator<Item = (u64, [f64; 3])> {
        self.items.iter().map(|item| (item.id, item.position))
    }

    /// Puts it into a server's world.
    pub(crate) async fn fill(&self, client: &Client) -> Result<(), Failure> {
        let mut writer = EditWriter::open(client, "bench").await?;
        for items in self.items.chunks(MESSAGE) {
            writer.commit(items.iter().map(Item::insert)).await?;
        }
        writer.flush().await?;
        Ok(())
    }

    /// Rays from anywhere in the cube.
    pub(crate) fn rays(&self, count: usize, dice: &mut Dice) -> Vec<proto::RaycastRequest> {
        let mut ray = || {
            // Singles, so that columns ask the same.
            let single = |number: f64| f64::from(number as f32);
            let direction = std::array::from_fn(|_| single(dice.between(-1.0, 1.0)));
            let mut ray = ask::ray(dice.point(self.side).map(single), direction);
            ray.max_distance = Some(RAY_LENGTH);
            ray
        };
        (0..count).map(|_| ray()).collect()
    }

    /// The same world without a server, with these rays to ask.
    pub(crate) fn library(&self, rays: &[proto::RaycastRequest]) -> Result<Library, Failure> {
        let mut world = World::new(Time(0));
        // By the messages that fill the server's, so that both have the same tree.
        for items in self.items.chunks(MESSAGE) {
            let inserts = items.iter().map(|item| Edit::Insert(item.shape())).collect();
            world.apply(inserts, Time(0), EditRule::AllOrNothing)?;
        }
        let vector = |sent: Option<proto::Vec3>| {
            let sent = sent.unwrap_or_default();
            DVec3::new(sent.x, sent.y, sent.z)
        };
        let ray = |ray: &proto::RaycastRequest| Raycast {
            ray: Ray {
                origin: vector(ray.origin),
                direction: vector(ray.direction),
                min_distance: 0.0,
                max_distance: RAY_LENGTH,
                hollow: false,
                faces: Faces::Both,
            },
            mode: HitMode::Closest,
        };
        Ok(Library { world: world.newest(), questions: rays.iter().map(ray).collect() })
    }
}

/// What is asked, in this process.
#[derive(Debug)]
pub(crate) struct Library {
    world: Arc<Snapshot>,
    questions: Vec<Raycast>,
}

impl Library {
    /// Asks all rays for some time, again and again; returns what one costs, and the share that hits.
    pub(crate) fn ray(&self, time: Duration) -> Result<(Duration, f64), Failure> {
        let mut keep_going = || true;
        let (began, cpu_before) = (Instant::now(), thread_cpu());
        let (mut count, mut hits) = (0_u32, 0);
        while began.elapsed() < time {
            for question in &self.questions {
                let meter = &mut Meter::new(&mut keep_going);
                let found = self.world.raycast(question, &Filter::default(), &Accuracy::default(), meter)?;
                hits += u32::from(!found.hits.is_empty());
            }
            count += u32::try_from(self.questions.len())?;
        }
        Ok(((thread_cpu() - cpu_before) / count.max(1), f64::from(hits) / f64::from(count.max(1))))
    }
}

/// Processor time of this thread.
fn thread_cpu() -> Duration {
    let taken = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(taken.tv_sec.unsigned_abs(), taken.tv_nsec as u32)
}

impl Item {
    fn insert(&self) -> proto::Edit {
        let shape = match self.form {
            Form::Box(half) => shape::cuboid(self.id, half),
            Form::Sphere(radius) => shape::sphere(self.id, radius),
            Form::Capsule { half_height, radius } => shape::capsule(self.id, half_height, radius),
        };
        shape.at(self.position).rotated(self.rotation).insert()
    }

    fn shape(&self) -> Shape {
        let geometry = match self.form {
            Form::Box(half) => Geometry::cuboid(DVec3::from_array(half)),
            Form::Sphere(radius) => Geometry::sphere(radius),
            Form::Capsule { half_height, radius } => Geometry::capsule(half_height, radius),
        };
        let pose = Pose::new(DVec3::from_array(self.position), DQuat::from_array(self.rotation));
        let geometry = Arc::new(geometry.expect("sizes are in range"));
        Shape::new(ShapeId::new(self.id).expect("ids begin at 1"), geometry, pose)
    }
}
