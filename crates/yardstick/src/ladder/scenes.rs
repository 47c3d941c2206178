//! Scenes of real assets in pairs.

use std::{hint::black_box, path::Path, time::Instant};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Work},
    math::Pose,
    narrow::{self, Placed},
    shape::Geometry,
};
use serde::Deserialize;

use super::FAR;
use crate::{
    scene::Random,
    sets::{SetError, read_lines, read_obj},
};

/// Pairs of each scene.
const PAIRS: usize = 300;

/// Geometries, and which of them are where.
pub(super) struct Scene {
    pub(super) name: &'static str,
    geometries: Vec<Geometry>,
    pairs: Vec<[(usize, Pose); 2]>,
}

#[derive(Deserialize)]
struct Cloud {
    v: Vec<[f64; 3]>,
}

/// Three scenes: hulls of whole assets, meshes of an animal, and a level with props.
pub(super) fn scenes(folder: &Path) -> Result<[Scene; 3], SetError> {
    let mesh = |name: &str| read_obj(&folder.join("mesh").join(name));
    let refused = |error: collision::shape::GeometryError| SetError::file(folder, error.to_string());
    let clouds = read_lines::<Cloud>(&folder.join("hulls_hzd.jsonl"))?;
    let props = clouds.iter().map(|(_, cloud)| {
        let points: Vec<DVec3> = cloud.v.iter().map(|&point| DVec3::from_array(point)).collect();
        Geometry::hull(&points)
    });
    let props: Vec<Geometry> = props.collect::<Result<_, _>>().map_err(refused)?;
    let mut hulls = Vec::new();
    for name in ["spot.obj", "teddy.obj", "featuretype.obj", "fcl_rob.obj", "voxel_mesh_01.obj"] {
        hulls.push(Geometry::hull(&mesh(name)?.vertices).map_err(refused)?);
    }
    let as_mesh = |name: &str| {
        let mesh = mesh(name)?;
        Geometry::mesh(&mesh.vertices, &mesh.triangles).map_err(refused)
    };
    let spot = as_mesh("spot.obj")?;
    let level = as_mesh("nav_test.obj")?;
    let mut random = Random::new(7);
    Ok([
        Scene::of("hulls of whole assets", hulls, 5, &mut random),
        Scene::of("spot and spot", vec![spot], 1, &mut random),
        Scene::of("nav_test and props", std::iter::once(level).chain(props).collect(), 1, &mut random),
    ])
}

impl Scene {
    /// One of the first few against any, from touching to twenty sizes apart.
    fn of(name: &'static str, geometries: Vec<Geometry>, few: usize, random: &mut Random) -> Self {
        let size = |at: usize| (geometries[at].local_bounds().max - geometries[at].local_bounds().min).length() * 0.5;
        let pairs = (0..PAIRS).map(|number| {
            let picked = [few, geometries.len()].map(|below| (random.bits() % below as u64) as usize);
            let far = [0.5, 1.0, 2.0, 5.0, 20.0][number % 5] * picked.map(size).iter().sum::<f64>();
            [(picked[0], 0.0), (picked[1], far)].map(|(at, far)| {
                let (rotation, place) = (random.rotation().normalize(), random.direction() * far);
                (at, Pose::new(place - rotation * geometries[at].local_bounds().center(), rotation))
            })
        });
        let pairs = pairs.collect();
        Self { name, geometries, pairs }
    }

    pub(super) fn pairs(&self) -> impl Iterator<Item = [Placed<'_>; 2]> {
        self.pairs.iter().map(|pair| pair.map(|(at, pose)| Placed { geometry: &self.geometries[at], pose }))
    }

    /// Milliseconds that building takes: ball and box, simplified hull, what exact questions about the first pairs need.
    pub(super) fn build(&self) -> [f64; 3] {
        let timed = |build: &dyn Fn()| {
            let begin = Instant::now();
            build();
            begin.elapsed().as_secs_f64() * 1e3
        };
        let rung = |rung| {
            self.geometries.iter().for_each(|geometry| {
                black_box(geometry.stand_in(rung));
            });
        };
        let ask = || {
            for [a, b] in self.pairs().take(100) {
                narrow::distance(a, b, FAR, &Accuracy::of(Tier::Exact), &mut Work::default());
            }
        };
        let volumes = timed(&|| rung(Representation::OrientedBox));
        let hull = timed(&|| rung(Representation::SimplifiedHull));
        let (first, again) = (timed(&ask), timed(&ask));
        [volumes, hull, first - again]
    }
}
