//! Reads what people type: points, directions and forms.

use std::str::FromStr;

use calipers_client::{geometry, proto};

/// Three numbers, written `X,Y,Z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Triple(pub(crate) [f64; 3]);

/// A form, written as in [`FORMS`], in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    Sphere(f64),
    Box([f64; 3]),
    Capsule { half_height: f64, radius: f64 },
    Cylinder { half_height: f64, radius: f64 },
    Cone { half_height: f64, radius: f64 },
    Ellipsoid([f64; 3]),
}

/// What the forms look like, for sentences about wrong ones.
const FORMS: &str = "sphere:RADIUS, box:HX,HY,HZ (half extents), capsule:HALF_HEIGHT,RADIUS, cylinder:HALF_HEIGHT,RADIUS, \
                     cone:HALF_HEIGHT,RADIUS or ellipsoid:RX,RY,RZ (half axes)";

impl FromStr for Triple {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = numbers(text)?;
        let triple = <[f64; 3]>::try_from(numbers.as_slice())
            .map_err(|_| format!("{} numbers found, three wanted: X,Y,Z, such as 0,1.5,-3", numbers.len()))?;
        Ok(Self(triple))
    }
}

impl FromStr for Form {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, sizes) = text.split_once(':').ok_or_else(|| format!("a form is {FORMS}"))?;
        let sizes = numbers(sizes)?;
        match (name, sizes.as_slice()) {
            ("sphere", &[radius]) => Ok(Self::Sphere(radius)),
            ("box", &[x, y, z]) => Ok(Self::Box([x, y, z])),
            ("capsule", &[half_height, radius]) => Ok(Self::Capsule { half_height, radius }),
            ("cylinder", &[half_height, radius]) => Ok(Self::Cylinder { half_height, radius }),
            ("cone", &[half_height, radius]) => Ok(Self::Cone { half_height, radius }),
            ("ellipsoid", &[x, y, z]) => Ok(Self::Ellipsoid([x, y, z])),
            ("sphere" | "box" | "capsule" | "cylinder" | "cone" | "ellipsoid", _) => {
                Err(format!("{} numbers do not make a {name}; a form is {FORMS}", sizes.len()))
            }
            _ => Err(format!("{name:?} is no form that can be written here; a form is {FORMS}")),
        }
    }
}

impl Form {
    /// The geometry. Whether its sizes are in range is for the server to say.
    pub(crate) fn geometry(self) -> proto::Geometry {
        match self {
            Self::Sphere(radius) => geometry::sphere(radius),
            Self::Box(half_extents) => geometry::cuboid(half_extents),
            Self::Capsule { half_height, radius } => geometry::capsule(half_height, radius),
            Self::Cylinder { half_height, radius } => geometry::cylinder(half_height, radius),
            Self::Cone { half_height, radius } => geometry::cone(half_height, radius),
            Self::Ellipsoid(radii) => geometry::ellipsoid(radii),
        }
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',').map(number).collect()
}

fn number(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| format!("{text:?} is not a number"))?;
    if number.is_finite() { Ok(number) } else { Err(format!("{text:?} is not a finite number")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triples_are_three_finite_numbers() {
        assert_eq!("1, -2.5,3e2".parse(), Ok(Triple([1.0, -2.5, 300.0])));
        for (wrong, said) in [("1,2", "2 numbers found"), ("1,2,x", "\"x\" is not a number"), ("1,nan,2", "finite")] {
            let sentence = wrong.parse::<Triple>().unwrap_err();
            assert!(sentence.contains(said), "{sentence}");
        }
    }

    #[test]
    fn forms_are_named_with_their_sizes() {
        assert_eq!("sphere:1.5".parse(), Ok(Form::Sphere(1.5)));
        assert_eq!("box:59,42,18".parse(), Ok(Form::Box([59.0, 42.0, 18.0])));
        assert_eq!("capsule:1,0.5".parse(), Ok(Form::Capsule { half_height: 1.0, radius: 0.5 }));
        assert_eq!("cylinder:1,0.5".parse(), Ok(Form::Cylinder { half_height: 1.0, radius: 0.5 }));
        assert_eq!("cone:1,0.5".parse(), Ok(Form::Cone { half_height: 1.0, radius: 0.5 }));
        assert_eq!("ellipsoid:1,2,3".parse(), Ok(Form::Ellipsoid([1.0, 2.0, 3.0])));
        for wrong in ["sphere", "sphere:1,2", "torus:1,2", "box:1,2", "cone:1", "ellipsoid:1,2", "capsule:inf,1"] {
            assert!(wrong.parse::<Form>().is_err(), "{wrong}");
        }
    }
}
