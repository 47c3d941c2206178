//! Balls that fly level through the rooms and bounce off what stands there.
//!
//! # Method
//! Before each step they ask the server, in one batch, what they would touch on the way (TimeOfImpact). The answer's
//! fraction says how far they get, its normal how they bounce; nothing is computed here but the mirrored velocity.

use std::f64::consts::TAU;

use calipers_client::{Client, Error, ask, geometry, proto};
use proto::answer::Answer;
use proto::question::Question;

use super::Dice;
use super::floor_plan::Room;
use super::level::{LAYER_LEVEL, about_y};

const RADIUS: f64 = 0.2;
/// Height of their middles.
const HEIGHT: f64 = 0.8;
/// What a ball keeps from what it bounces off, so that the next step does not begin in touch.
const GAP: f64 = 1e-3;

/// The balls.
#[derive(Debug)]
pub(super) struct Balls {
    balls: Vec<Ball>,
}

/// One of them; all vectors are x and z.
#[derive(Clone, Copy, Debug)]
struct Ball {
    at: [f64; 2],
    velocity: [f64; 2],
}

impl Balls {
    /// One ball in the middle of each of these rooms; a room may be given more than once.
    pub(super) fn new(rooms: impl Iterator<Item = Room>, dice: &mut Dice) -> Self {
        let ball = |room: Room| {
            let [x, z] = room.middle();
            let turn = dice.between(0.0, TAU);
            let speed = dice.between(1.5, 5.0);
            Ball {
                at: [x + dice.between(-0.5, 0.5), z + dice.between(-0.5, 0.5)],
                velocity: [speed * turn.cos(), speed * turn.sin()],
            }
        };
        Self { balls: rooms.map(ball).collect() }
    }

    pub(super) fn form() -> proto::Geometry {
        geometry::sphere(RADIUS)
    }

    /// Where they are, and how they are turned.
    pub(super) fn places(&self) -> impl Iterator<Item = ([f64; 3], [f64; 4])> {
        self.balls.iter().map(|ball| (level(ball.at), about_y(0.0)))
    }

    /// Goes on by some seconds.
    ///
    /// # Errors
    /// What the server says of the batch, or of one of its questions.
    pub(super) async fn step(&mut self, client: &Client, seconds: f64) -> Result<(), Error> {
        let question = |ball: &Ball| {
            let subject = ask::form_at(Self::form(), level(ball.at));
            Question::from(ask::time_of_impact(subject, level(ball.ahead(seconds))))
        };
        let mut batch = ask::batch(self.balls.iter().map(question));
        // Only the level is in their way: balls pass each other, and the ground is below the floor.
        let filter = proto::Filter { collides_with: Some(LAYER_LEVEL), ..proto::Filter::default() };
        batch.options = Some(Box::new(proto::QueryOptions { filter: Some(filter), ..proto::QueryOptions::default() }));
        let answers = client.batch(batch).await?.answers;
        for (ball, answer) in self.balls.iter_mut().zip(answers) {
            match answer.answer {
                Some(Answer::TimeOfImpact(answer)) => ball.go(seconds, answer.hits.first()),
                Some(Answer::Problem(problem)) => {
                    return Err(tonic::Status::new(problem.code.into(), problem.message).into());
                }
                _ => return Err(tonic::Status::internal("a ball's question got no answer of its kind").into()),
            }
        }
        Ok(())
    }
}

impl Ball {
    /// Where it would be with nothing in the way.
    fn ahead(&self, seconds: f64) -> [f64; 2] {
        let [x, z] = self.velocity;
        [self.at[0] + seconds * x, self.at[1] + seconds * z]
    }

    /// Goes as far as it can, and bounces if something was in the way.
    fn go(&mut self, seconds: f64, touched: Option<&proto::Impact>) {
        let Some(touched) = touched else {
            self.at = self.ahead(seconds);
            return;
        };
        let way = seconds * self.velocity[0].hypot(self.velocity[1]);
        let free = (touched.fraction.unwrap_or(0.0) * way - GAP).max(0.0);
        self.at = self.ahead(seconds * free / way);
        self.velocity = match touched.normal {
            Some(normal) => mirrored(self.velocity, [normal.x, normal.z]),
            None => self.velocity.map(|component| -component),
        };
    }
}

/// The velocity after a bounce: level, and as fast as before. Off a normal that says nothing of the level directions, or
/// that it already flies away from, it turns back or flies on.
fn mirrored([x, z]: [f64; 2], [normal_x, normal_z]: [f64; 2]) -> [f64; 2] {
    let length = normal_x.hypot(normal_z);
    if length < 0.1 {
        return [-x, -z];
    }
    let [normal_x, normal_z] = [normal_x / length, normal_z / length];
    let approach = x * normal_x + z * normal_z;
    let twice = -2.0 * approach.min(0.0);
    [x + twice * normal_x, z + twice * normal_z]
}

fn level([x, z]: [f64; 2]) -> [f64; 3] {
    [x, HEIGHT, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bounce_turns_what_goes_in_and_keeps_what_goes_along() {
        assert_eq!(mirrored([3.0, -4.0], [0.0, 1.0]), [3.0, 4.0]);
        assert_eq!(mirrored([3.0, 4.0], [0.0, 1.0]), [3.0, 4.0]);
        assert_eq!(mirrored([3.0, 4.0], [0.0, 0.0]), [-3.0, -4.0]);
    }

    #[test]
    fn a_ball_stops_short_of_what_it_touches() {
        let mut ball = Ball { at: [0.0, 0.0], velocity: [2.0, 0.0] };
        let normal = Some(proto::Vec3 { x: -1.0, y: 0.0, z: 0.0 });
        ball.go(1.0, Some(&proto::Impact { fraction: Some(0.5), normal, ..proto::Impact::default() }));
        assert_eq!((ball.at, ball.velocity), ([1.0 - GAP, 0.0], [-2.0, 0.0]));
    }
}
