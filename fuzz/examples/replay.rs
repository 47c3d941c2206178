//! Puts files to a target without libFuzzer, and random bytes if there are no files:
//! `cargo run --release --example replay -- pairs [FILE…]`. Prints one line for each law that is broken.

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

fn main() {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_default();
    let target: fn(&[u8]) = match name.as_str() {
        "pairs" => calipers_fuzz::pairs::check,
        "hulls" => calipers_fuzz::hulls::check,
        "rays" => calipers_fuzz::rays::check,
        _ => panic!("name a target: pairs, hulls or rays"),
    };
    panic::set_hook(Box::new(|info| {
        let place = info.location().map_or_else(String::new, ToString::to_string);
        PLACE.with(|kept| *kept.borrow_mut() = place);
    }));
    let files: Vec<String> = arguments.collect();
    if !files.is_empty() {
        for file in files {
            let bytes = std::fs::read(&file).expect("a readable file");
            if let Some(broken) = broken(target, &bytes) {
                println!("{file}: {broken}");
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
            // Laws are told apart by where they stand.
            let kind: String = broken.split(' ').take(2).collect::<Vec<_>>().join(" ");
            let seen = kinds.entry(kind).or_default();
            *seen += 1;
            if *seen <= 2 {
                println!("{broken}");
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

fn broken(target: fn(&[u8]), bytes: &[u8]) -> Option<String> {
    let panicked = panic::catch_unwind(AssertUnwindSafe(|| target(bytes))).err()?;
    let text = panicked.downcast_ref::<String>().cloned();
    let text = text.or_else(|| panicked.downcast_ref::<&str>().map(|&text| text.to_owned())).unwrap_or_default();
    if text.starts_with("BROKEN") {
        return Some(text);
    }
    Some(format!("PANIC {} {text}", PLACE.with(|place| place.borrow().clone())))
}

fn random_byte(state: &mut u64) -> u8 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 24) as u8
}
