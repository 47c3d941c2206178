//! Draws a floor plan of the demo level from what rays hit: the picture in the README.
//!
//! ```text
//! cargo run --release -- serve --demo
//! cargo run --release --example floor_plan > docs/demo.svg    # or with an address
//! ```
//!
//! 150 rays go out level from the middle of each of the 24 rooms, all in one batch and so on one tick. What they hit is
//! drawn as a dot: dark where it stands, red where it moves.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::Write as _;

use calipers_client::{Client, ask, proto};
use proto::question::Question;

/// Rays from each place.
const RAY_COUNT: u32 = 150;
/// Height of the rays, metres.
const HEIGHT: f64 = 1.2;
/// Half of what is drawn, metres.
const HALF_VIEW: [f64; 2] = [36.0, 26.0];
/// What moves has ids from this on.
const FIRST_MOVING_ID: u64 = 10_000;

#[tokio::main]
async fn main() -> Result<(), Box<dyn Error>> {
    let address = std::env::args().nth(1).unwrap_or_else(|| "http://127.0.0.1:7070".to_owned());
    let client = Client::connect(&address).await?;
    let mut questions = Vec::new();
    for [x, z] in places() {
        for i in 0..RAY_COUNT {
            let angle = f64::from(i) / f64::from(RAY_COUNT) * TAU;
            let ray = proto::RaycastRequest {
                max_distance: Some(60.0),
                ..ask::ray([x, HEIGHT, z], [angle.cos(), 0.0, angle.sin()])
            };
            questions.push(Question::Raycast(ray));
        }
    }
    let answers = client.batch(ask::batch(questions)).await?.answers;
    std::io::stdout().write_all(drawing(&answers)?.as_bytes())?;
    Ok(())
}

/// The middles of the rooms: six along x, four along z.
fn places() -> impl Iterator<Item = [f64; 2]> {
    (0..24).map(|i| [f64::from(i % 6) * 10.0 - 25.0, f64::from(i / 6) * 10.0 - 15.0])
}

/// The hits as dots over the rays that found them.
fn drawing(answers: &[proto::Answer]) -> Result<String, std::fmt::Error> {
    let [half_x, half_z] = HALF_VIEW;
    let mut svg = String::new();
    writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="{} {} {} {}" width="1080" height="780">
<rect x="-50%" y="-50%" width="100%" height="100%" fill="#fbfaf7"/>
<g stroke="#d9d3c3" stroke-width="0.03">"##,
        -half_x,
        -half_z,
        2.0 * half_x,
        2.0 * half_z
    )?;
    let (mut still, mut moving) = (String::new(), String::new());
    for (i, answer) in answers.iter().enumerate() {
        let Some(proto::answer::Answer::Raycast(response)) = &answer.answer else {
            continue;
        };
        let Some((hit, point)) = response.hits.first().and_then(|hit| Some((hit, hit.point?))) else {
            continue;
        };
        let Some([x, z]) = places().nth(i / RAY_COUNT as usize) else {
            continue;
        };
        writeln!(svg, r#"<path d="M{x} {z}L{:.2} {:.2}"/>"#, point.x, point.z)?;
        let dots = if hit.id >= FIRST_MOVING_ID { &mut moving } else { &mut still };
        writeln!(dots, r#"<circle cx="{:.2}" cy="{:.2}" r="0.12"/>"#, point.x, point.z)?;
    }
    writeln!(svg, "</g>\n<g fill=\"#2b3a4a\">\n{still}</g>\n<g fill=\"#d1442f\">\n{moving}</g>\n</svg>")?;
    Ok(svg)
}
