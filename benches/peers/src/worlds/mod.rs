//! Part A: worlds of many shapes. `trees` measures what it costs to keep their boxes, `questions` what answers cost.

mod obvhs;
mod questions;
mod rows;
mod trees;
mod workload;

use std::io;

pub(crate) use rows::{Task, rows};

use crate::{
    report::Outcome,
    rows::{Row, Task as AnyTask},
};
use questions::Worlds;
use rows::Operation;
use workload::Workload;

/// Measures those of the rows that are of part A, world by world, and hands over each as it is done.
pub(crate) fn measure(rows: &[Row], mut done: impl FnMut(Outcome) -> io::Result<()>) -> io::Result<()> {
    let tasks = rows.iter().filter_map(|row| match row.task {
        AnyTask::World(task) => Some((row, task)),
        AnyTask::Pair(_) | AnyTask::Mesh(_) => None,
    });
    let tasks: Vec<(&Row, Task)> = tasks.collect();
    let mut shape_counts: Vec<u32> = tasks.iter().map(|(_, task)| task.shape_count).collect();
    shape_counts.sort_unstable();
    shape_counts.dedup();
    for shape_count in shape_counts {
        let workload = Workload::new(shape_count as usize);
        let shapes = questions::shapes(&workload);
        // Not built for rows of trees alone.
        let mut worlds: Option<Worlds<'_>> = None;
        for (row, task) in tasks.iter().filter(|(_, task)| task.shape_count == shape_count) {
            let (times, errors) = match task.operation {
                Operation::Work(work) => trees::measure(&workload, work),
                Operation::Ask(question) => {
                    worlds.get_or_insert_with(|| Worlds::new(&workload, &shapes)).measure(question)
                }
            };
            done(Outcome { row: (*row).clone(), times, errors })?;
        }
    }
    Ok(())
}
