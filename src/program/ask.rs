//! The one-liners that ask: a ray, an overlap, a description.

use std::io::Write;
use std::time::Duration;

use calipers_client::{ask, proto};
use clap::Args;

use super::Failure;
use super::input::{Form, Triple};
use super::target::Target;
use super::{json, print};

/// A person waits no longer for an answer.
const DEADLINE: Duration = Duration::from_secs(10);

/// Asks what a ray hits.
#[derive(Debug, Args)]
#[command(after_help = "Example: calipers raycast 0,10,0 0,-1,0\nA miss is an answer too: the exit code is 0.")]
pub(crate) struct Raycast {
    /// Where the ray begins, in metres
    #[arg(value_name = "X,Y,Z", allow_hyphen_values = true)]
    origin: Triple,
    /// Where it goes; any length but 0
    #[arg(value_name = "DX,DY,DZ", allow_hyphen_values = true)]
    direction: Triple,
    /// All hits, closest first, and not only the closest
    #[arg(long)]
    all: bool,
    /// How far it goes, in metres
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    max: Option<f64>,
    /// The answer as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    target: Target,
}

/// Asks what touches a form.
#[derive(Debug, Args)]
#[command(after_help = "Example: calipers overlap capsule:0.6,0.3 --at 4,0.9,-2")]
pub(crate) struct Overlap {
    /// The form: sphere:RADIUS, box:HX,HY,HZ (half extents), capsule:, cylinder: or cone:HALF_HEIGHT,RADIUS (along y) or
    /// ellipsoid:RX,RY,RZ (half axes), in metres
    #[arg(value_name = "FORM")]
    form: Form,
    /// Where its centre is
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true)]
    at: Triple,
    /// The answer as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    target: Target,
}

/// Says what a world holds.
#[derive(Debug, Args)]
pub(crate) struct Describe {
    /// The description as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    target: Target,
}

impl Raycast {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let client = self.target.connect(DEADLINE).await?;
        let mut question = ask::ray(self.origin.0, self.direction.0);
        question.max_distance = self.max;
        if self.all {
            question.mode = proto::HitMode::All.into();
        }
        let answer = client.raycast(question).await?;
        let text = if self.json { json::raycast(&answer).to_string() } else { print::raycast(&answer) };
        Ok(writeln!(out, "{text}")?)
    }
}

impl Overlap {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let client = self.target.connect(DEADLINE).await?;
        let answer = client.overlap(ask::overlap(ask::form_at(self.form.geometry(), self.at.0))).await?;
        let text = if self.json { json::overlap(&answer).to_string() } else { print::overlap(&answer) };
        Ok(writeln!(out, "{text}")?)
    }
}

impl Describe {
    pub(crate) async fn run(self, out: &mut impl Write) -> Result<(), Failure> {
        let client = self.target.connect(DEADLINE).await?;
        let world = client.describe_world(proto::DescribeWorldRequest::default()).await?;
        let text = if self.json { json::world(&world).to_string() } else { print::world(&world) };
        Ok(writeln!(out, "{text}")?)
    }
}
