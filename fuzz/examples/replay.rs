//! Puts files to a target without libFuzzer, and random bytes if there are no files:
//! `cargo run --release --example replay -- pairs [FILE…]`. Prints each law that is broken with the least case found.

use std::{
    cell::RefCell,
    collections::BTreeMap,
    panic::{self, AssertUnwindSafe},
    time::{Duration, Instant},
};

thread_local! {
    /// Where the last panic was.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// The laws of a target, and the case that bytes make, as code.
type Target = (fn(&[u8]), fn(&[u8]) -> String);

fn main() {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_default();
    let target: Target = match name.as_str() {
        "pairs" => (calipers_fuzz::pairs::check, calipers_fuzz::pairs::describe),
        "hulls" => (calipers_fuzz::hulls::check, calipers_fuzz::hulls::describe),
        "rays" => (calipers_fuzz::rays::check, calipers_fuzz::rays::describe),
        "worlds" => (calipers_fuzz::worlds::check, calipers_fuzz::worlds::describe),
        _ => panic!("name a target: pairs, hulls, rays or worlds"),
    };
    panic::set_hook(Box::new(|info| {
        let place = info.location().map_or_else(String::new, ToString::to_string);
        PLACE.with(|kept| *kept.borrow_mut() = place);
    }));
    let files: Vec<String> = arguments.collect();
    if !files.is_empty() {
        for file in files {
            let bytes = std::fs::read(&file).expect("a readable file");
            if broken(target, &bytes).is_some() {
                println!("{file}: {}", smallest(target, bytes).1);
            }
        }
        return;
    }
    let seconds = std::env::var("SECONDS_LONG").ok().and_then(|text| text.parse().ok()).unwrap_or(60);
    let mut state = std::env::var("SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1_u64);
    let mut kinds = BTreeMap::<String, usize>::new();
    let (begin, mut count) = (Instant::now(), 0_u64);
    while begin.elapsed() < Duration::from_secs(seconds) {
        let bytes: Vec<u8> = (0..400).map(|_| random_byte(&mut state)).collect();
        count += 1;
        let since = Instant::now();
        if let Some(broken) = broken(target, &bytes) {
            let kind = kind(&broken);
            let seen = kinds.entry(kind).or_default();
            *seen += 1;
            if *seen <= 2 {
                println!("{}", smallest(target, bytes.clone()).1);
            }
        }
        if since.elapsed() > Duration::from_secs(2) {
            println!("SLOW: {:?}: {bytes:?}", since.elapsed());
        }
    }
    println!("{count} cases");
    for (kind, seen) in kinds {
        println!("{seen:6} {kind}");
    }
}

/// Laws are told apart by where they stand.
fn kind(broken: &str) -> String {
    broken.split(' ').take(2).collect::<Vec<_>>().join(" ")
}

/// Leaves out and zeroes bytes as long as the same law is broken.
fn smallest(target: Target, bytes: Vec<u8>) -> (Vec<u8>, String) {
    let mut best = (broken(target, &bytes).unwrap_or_default(), bytes);
    let law = kind(&best.0);
    let begin = Instant::now();
    for length in [64, 16, 4, 1, 16, 4, 1] {
        let mut at = 0;
        while at < best.1.len() && begin.elapsed() < Duration::from_secs(10) {
            let end = (at + length).min(best.1.len());
            let without = [&best.1[..at], &best.1[end..]].concat();
            let zeroed = [&best.1[..at], &vec![0; end - at], &best.1[end..]].concat();
            let candidates = [without, zeroed].into_iter().filter(|tried| *tried != best.1);
            let mut same = candidates.filter_map(|tried| {
                broken(target, &tried).filter(|found| kind(found) == law).map(|found| (found, tried))
            });
            match same.next() {
                Some(smaller) => best = smaller,
                None => at += length,
            }
        }
    }
    (best.1, best.0)
}

fn broken(target: Target, bytes: &[u8]) -> Option<String> {
    let panicked = panic::catch_unwind(AssertUnwindSafe(|| target.0(bytes))).err()?;
    let text = panicked.downcast_ref::<String>().cloned();
    let text = text.or_else(|| panicked.downcast_ref::<&str>().map(|&text| text.to_owned())).unwrap_or_default();
    if text.starts_with("BROKEN") {
        return Some(text);
    }
    Some(format!("PANIC {} {text}\n{}", PLACE.with(|place| place.borrow().clone()), target.1(bytes)))
}

fn random_byte(state: &mut u64) -> u8 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 24) as u8
}
