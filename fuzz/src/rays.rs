//! A ray and a form of any kind.

use std::fmt;

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Bound, Verdict, Work},
    math::{Pose, exact::two_sum},
    narrow::{self, Faces, InitialTouch, Motion, Placed, Ray, RayTouch, RayTouches},
    shape::{Form, Geometry, MeshMode},
};

use crate::{
    forms::{self, Made},
    law,
    numbers::{Numbers, pose_code, vector_code, vector_within},
};

/// Panics if the touches of the ray and the form that these bytes make break a law.
pub fn check(bytes: &[u8]) {
    let numbers = &mut Numbers::new(bytes);
    let Some(case) = Case::new(numbers) else { return };
    let touches = case.cast(&case.ray);
    case.is_sound(&touches, &case.ray);
    for faces in [Faces::Front, Faces::Back] {
        let ray = Ray { faces, ..case.ray };
        case.is_sound(&case.cast(&ray), &ray);
    }
    case.hollow_and_solid_agree(&touches);
    case.way_is_free(&touches);
    case.back_again(&touches);
    case.as_a_moving_point(&touches);
}

/// The case that these bytes make, as code.
#[must_use]
pub fn describe(bytes: &[u8]) -> String {
    Case::new(&mut Numbers::new(bytes)).map_or_else(String::new, |case| case.to_string())
}

struct Case {
    form: Made,
    pose: Pose,
    ray: Ray,
    accuracy: Accuracy,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Ray { origin, direction, min_distance, max_distance, hollow, .. } = self.ray;
        writeln!(f, "    let form = {};", self.form.code)?;
        writeln!(f, "    let pose = {};", pose_code(&self.pose))?;
        let (origin, direction) = (vector_code(origin), vector_code(direction));
        writeln!(
            f,
            "    let ray = Ray {{ origin: {origin}, direction: {direction}, min_distance: {min_distance:?}, max_distance: {max_distance:?}, hollow: {hollow}, faces: Faces::Both }};"
        )
    }
}

impl Case {
    fn new(numbers: &mut Numbers<'_>) -> Option<Self> {
        let form = forms::form(numbers)?;
        let pose = numbers.pose();
        let on_form = |numbers: &mut Numbers<'_>| {
            let bounds = form.geometry.local_bounds();
            let pick =
                [0, 1, 2].map(|axis| [bounds.min[axis], 0.0, bounds.max[axis], bounds.min[axis]][numbers.below(4)]);
            let vertices = match form.geometry.form() {
                Form::Mesh(mesh) => mesh.vertices(),
                Form::Convex(collision::shape::Convex { core: collision::shape::Core::Hull(hull), .. }) => {
                    hull.vertices()
                }
                _ => &[],
            };
            let vertex = vertices.get(numbers.below(vertices.len().clamp(1, 256)));
            vector_within(pose.transform_point(*vertex.unwrap_or(&vector_within(DVec3::from_array(pick)))))
        };
        let origin = match numbers.below(5) {
            0 => on_form(numbers),
            1 => {
                pose.position + numbers.direction() * form.geometry.reach().min(1e12) * f64::from(numbers.byte()) / 64.0
            }
            2 => pose.position + numbers.vector(),
            3 => pose.position - numbers.direction() * [1.0, 64.0, 1e4, 1e9, 1e11][numbers.below(5)],
            _ => numbers.vector(),
        };
        let origin = vector_within(origin);
        let mut direction = match numbers.below(7) {
            0 | 1 => numbers.direction(),
            2 => pose.position - origin,
            3 | 4 => on_form(numbers) - origin,
            5 => (on_form(numbers) * 0.5 + on_form(numbers) * 0.5) - origin,
            _ => numbers.vector(),
        };
        if numbers.below(8) == 0 {
            direction *= [1e-300, 1e290, 1e-160, 3.0, 1e-310, -1.0][numbers.below(6)];
        }
        if direction == DVec3::ZERO || !direction.is_finite() {
            direction = DVec3::X;
        }
        let max_distance = if numbers.below(3) == 0 { numbers.length(4e12) } else { 4e12 };
        let min_distance = if numbers.below(4) == 0 { numbers.length(max_distance).min(max_distance) } else { 0.0 };
        let hollow = numbers.byte() & 1 == 1;
        let min_distance = if min_distance.is_finite() { min_distance } else { 0.0 };
        let ray = Ray { origin, direction, min_distance, max_distance, hollow, faces: Faces::Both };
        let accuracy = Accuracy::of([Tier::Exact, Tier::Standard, Tier::Fast][numbers.below(3)]);
        Some(Self { form, pose, ray, accuracy })
    }

    /// Whether some of its triangles let a ray through from behind.
    fn is_one_sided(&self) -> bool {
        self.form.has_mode(|mode| mode == MeshMode::OneSided)
    }

    fn target(&self) -> Placed<'_> {
        self.form.at(self.pose)
    }

    fn cast(&self, ray: &Ray) -> RayTouches {
        narrow::raycast(ray, self.target(), &self.accuracy, &mut Work::default())
    }

    /// What rounding is relative to, metres.
    fn extent(&self) -> f64 {
        let reach = match self.form.geometry.form() {
            Form::HalfSpace(space) => space.offset.abs(),
            _ => self.form.geometry.reach(),
        };
        reach + (self.ray.origin - self.pose.position).length()
    }

    fn slack(&self, distance: f64) -> f64 {
        let far = self.pose.position.length() + self.ray.origin.length() + distance;
        1e-12 * self.extent() + 8.0 * f64::EPSILON * far
    }

    fn is_sound(&self, touches: &RayTouches, ray: &Ray) {
        let is_surface = matches!(self.form.geometry.form(), Form::Mesh(mesh) if mesh.mode() != MeshMode::Solid);
        let has_inside = !is_surface;
        for (touch, verdict) in [(touches.certain, Verdict::Hit), (touches.undecided, Verdict::Undecided)] {
            let Some(touch) = touch else { continue };
            let bound = touch.certificate.bound;
            law!(self, touch.certificate.verdict == verdict, "{touches:?}");
            law!(self, bound.contains(touch.distance), "{:?}: {touches:?}", ray.faces);
            law!(self, touch.point.is_finite() && touch.distance.is_finite(), "{touches:?}");
            law!(self, touch.normal.is_none_or(|n| (n.length() - 1.0).abs() <= 1e-14), "{touches:?}");
            law!(self, has_inside || !touch.inside, "{touches:?}");
            if verdict == Verdict::Hit {
                let in_limits = ray.min_distance <= touch.distance && touch.distance <= ray.max_distance;
                law!(self, in_limits, "{:?}: {touches:?}", ray.faces);
                self.is_on_the_surface(&touch);
            }
        }
    }

    fn is_on_the_surface(&self, touch: &RayTouch) {
        // Forms whose size has no square count as nothing, wherever they are.
        let reach = self.form.geometry.reach();
        if reach > 0.0 && reach < 1e-138 {
            return;
        }
        let slack = self.slack(touch.distance);
        let off = self.apart(touch.point);
        let width = if touch.certificate.bound.width().is_finite() { touch.certificate.bound.width() } else { 0.0 };
        law!(self, off.lower <= slack + width, "{:?} off the form: {touch:?}", off);
        let unit = unit(self.ray.direction);
        let along = (touch.point - self.ray.origin).dot(unit);
        let beside = (touch.point - self.ray.origin - unit * touch.distance).length();
        law!(self, beside <= slack, "{beside:?} off the ray, {along:?} along: {touch:?}");
    }

    fn apart(&self, point: DVec3) -> Bound {
        let probe = Geometry::point();
        let probe = Placed { geometry: &probe, pose: Pose::at(point) };
        let exact = Accuracy::of(Tier::Exact);
        let found = narrow::distance(probe, self.target(), f64::INFINITY, &exact, &mut Work::default());
        found.map_or(Bound::UNBOUNDED, |found| found.certificate.bound)
    }

    /// From outside both see the same wall; from inside the solid one is met at once.
    fn hollow_and_solid_agree(&self, touches: &RayTouches) {
        let other = self.cast(&Ray { hollow: !self.ray.hollow, ..self.ray });
        let (solid, hollow) = if self.ray.hollow { (&other, touches) } else { (touches, &other) };
        if let (Some(wall), None) = (hollow.certain, solid.undecided) {
            law!(self, solid.certain.is_some(), "hollow {wall:?}, but solid never");
        }
        let (Some(body), Some(wall)) = (solid.certain, hollow.certain) else { return };
        let order = body.certificate.bound.lower <= wall.certificate.bound.upper;
        law!(self, order, "solid {body:?} after hollow {wall:?}");
        if !body.inside && hollow.undecided.is_none() && solid.undecided.is_none() {
            let bounds = (body.certificate.bound, wall.certificate.bound);
            let meet = bounds.0.upper >= bounds.1.lower;
            law!(self, meet, "solid {body:?} before hollow {wall:?}");
        }
    }

    /// Up to the first touch no point of a solid form is met for certain.
    fn way_is_free(&self, touches: &RayTouches) {
        if self.ray.hollow {
            return;
        }
        let lower = |touch: Option<RayTouch>| touch.map_or(f64::INFINITY, |touch| touch.certificate.bound.lower);
        let free_until = lower(touches.certain).min(lower(touches.undecided)).min(self.ray.max_distance);
        let unit = unit(self.ray.direction);
        let foot = (self.pose.position - self.ray.origin).dot(unit);
        let reach = self.extent();
        let probe = Geometry::point();
        for step in -2..=8 {
            let way =
                if step < 0 { foot + f64::from(step + 1) * 0.25 * reach } else { free_until * f64::from(step) / 8.0 };
            if !(self.ray.min_distance..free_until).contains(&way) || way > 1e13 {
                continue;
            }
            let point = self.ray.origin + unit * way;
            let probe = Placed { geometry: &probe, pose: Pose::at(point) };
            let found =
                narrow::penetration(probe, self.target(), 0.0, &Accuracy::of(Tier::Exact), &mut Work::default());
            for contact in found.iter().flatten() {
                let slack = self.slack(way);
                law!(self, contact.certificate.bound.lower <= slack, "inside at {way:?}: {contact:?}, {touches:?}");
            }
        }
    }

    /// From an exact point beyond the touch, the same line meets something on its way back.
    fn back_again(&self, touches: &RayTouches) {
        let Some(touch) = touches.certain else { return };
        if self.is_one_sided() {
            return;
        }
        let Some((end, length)) = self.beyond(touch.certificate.bound.upper) else { return };
        let ray = Ray {
            origin: end,
            direction: -self.ray.direction,
            min_distance: 0.0,
            max_distance: 4e13,
            hollow: self.ray.hollow,
            faces: Faces::Both,
        };
        let back = self.cast(&ray);
        self.is_back(&back, touch, length);
    }

    fn is_back(&self, back: &RayTouches, touch: RayTouch, length: f64) {
        law!(self, back.certain.is_some() || back.undecided.is_some(), "{touch:?}, but none on the way back");
        let lower = |touch: Option<RayTouch>| touch.map_or(f64::INFINITY, |touch| touch.certificate.bound.lower);
        let first = lower(back.certain).min(lower(back.undecided));
        let latest = (length - touch.certificate.bound.lower) * (1.0 + 1e-14) + 4.0 * f64::EPSILON * length;
        law!(self, first <= latest, "{touch:?}, on the way back {back:?} over {length:?}");
    }

    /// A point of the ray beyond a distance, if it is exactly on it, and how far that is.
    fn beyond(&self, distance: f64) -> Option<(DVec3, f64)> {
        let length = self.ray.direction.length();
        if !(1e-100..1e100).contains(&length) {
            return None;
        }
        let steps = (2.0 * distance / length).max(f64::MIN_POSITIVE).log2().ceil().exp2();
        let way = self.ray.direction * steps;
        let is_exact = |axis: usize| {
            // What is subnormal counts as nothing beside the rest.
            self.ray.direction[axis] == 0.0 && way[axis] == 0.0
                || self.ray.direction[axis].abs() > 1e-290
                    && way[axis] / steps == self.ray.direction[axis]
                    && two_sum(self.ray.origin[axis], way[axis]).1 == 0.0
        };
        let end = self.ray.origin + way;
        let is_in_limits = end.abs().max_element() <= 1e12;
        (is_in_limits && (0..3).all(is_exact)).then_some((end, length * steps))
    }

    /// A point that moves along the ray touches when the ray does.
    fn as_a_moving_point(&self, touches: &RayTouches) {
        let (Some(touch), None) = (touches.certain, touches.undecided) else { return };
        if self.ray.min_distance > 0.0 || self.ray.hollow || self.is_one_sided() {
            return;
        }
        let Some((end, length)) = self.beyond(touch.certificate.bound.upper) else { return };
        let probe = Geometry::point();
        let probe = Placed { geometry: &probe, pose: Pose::at(self.ray.origin) };
        let way = end - self.ray.origin;
        let is_exact = (0..3).all(|axis| two_sum(end[axis], -self.ray.origin[axis]).1 == 0.0);
        if !is_exact {
            return;
        }
        let motion = Motion {
            displacement_a: way,
            displacement_b: DVec3::ZERO,
            rotation_a: DVec3::ZERO,
            rotation_b: DVec3::ZERO,
            initial: InitialTouch::Counts,
        };
        let found = narrow::impact(probe, self.target(), &motion, &self.accuracy, &mut Work::default());
        let Some(found) = found else { panic!("BROKEN a point never touches, the ray does: {touch:?}\n{self}") };
        let bound = found.certificate.bound;
        let slack = 1e-14 * length;
        law!(
            self,
            bound.lower * length <= touch.certificate.bound.upper + slack,
            "a point {found:?}, the ray {touch:?}"
        );
        // The plane of a triangle is felt by a point, not by a ray that lies in it.
        if found.certificate.verdict == Verdict::Hit && !self.form.is_concave() {
            let meet = bound.upper * length >= touch.certificate.bound.lower - slack;
            law!(self, meet, "a point {found:?}, the ray {touch:?}");
        }
    }
}

/// A unit vector along one of any length.
fn unit(direction: DVec3) -> DVec3 {
    let largest = direction.abs().max_element();
    let scaled = if largest < 1e-300 { direction * 1e300 / (largest * 1e300) } else { direction / largest };
    scaled.normalize()
}
