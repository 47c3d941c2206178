//! Answers kept for a while, so that a request which is sent again gets the first answer and is not done twice.

use std::{
    collections::{HashMap, VecDeque},
    time::{Duration, Instant},
};

use prost::Message;

use crate::problem::{Checked, Problem, Reason};

/// How long an answer is kept.
const KEPT_FOR: Duration = Duration::from_secs(300);
/// Most answers that are kept; beyond, the oldest go first.
const MOST: usize = 4096;
/// Items, such as hits, that all kept answers may hold together; beyond, the oldest go first.
const MOST_ITEMS: usize = 1 << 18;
/// Longest request id.
const ID_BYTES: usize = 128;

/// Which request an answer belongs to: its id and the hash of all of it.
#[derive(Clone, Debug)]
pub(crate) struct RetryKey {
    id: String,
    content: [u8; 32],
}

impl RetryKey {
    /// The key of a request; `None` if it has no id.
    ///
    /// # Errors
    /// The id is too long.
    pub(crate) fn of(request_id: &str, request: &impl Message) -> Checked<Option<Self>> {
        if request_id.len() > ID_BYTES {
            let what =
                format!("has {} bytes: at most {ID_BYTES} are allowed, so choose a shorter one", request_id.len());
            return Err(Problem::at("request_id", Reason::OutOfLimits, what));
        }
        Ok((!request_id.is_empty())
            .then(|| Self { id: request_id.to_owned(), content: *blake3::hash(&request.encode_to_vec()).as_bytes() }))
    }
}

/// The answers of the last five minutes, by request id.
#[derive(Debug)]
pub(crate) struct RetryCache<A> {
    answers: HashMap<String, Kept<A>>,
    by_age: VecDeque<(Instant, String)>,
    /// Of all of them.
    item_count: usize,
}

#[derive(Debug)]
struct Kept<A> {
    content: [u8; 32],
    answer: A,
    item_count: usize,
}

impl<A> Default for RetryCache<A> {
    fn default() -> Self {
        Self { answers: HashMap::new(), by_age: VecDeque::new(), item_count: 0 }
    }
}

impl<A: Clone> RetryCache<A> {
    /// The answer that this request got before.
    ///
    /// # Errors
    /// The id was used for another request.
    pub(crate) fn find(&mut self, key: Option<&RetryKey>, now: Instant) -> Checked<Option<A>> {
        self.forget_old(now);
        let Some(key) = key else { return Ok(None) };
        match self.answers.get(&key.id) {
            None => Ok(None),
            Some(kept) if kept.content == key.content => Ok(Some(kept.answer.clone())),
            Some(_) => {
                let what = format!("is {:?}, which another request used within 5 minutes: choose a new one", key.id);
                Err(Problem::at("request_id", Reason::OutOfLimits, what))
            }
        }
    }

    /// Keeps an answer of a fixed size.
    pub(crate) fn keep(&mut self, key: Option<RetryKey>, answer: &A, now: Instant) {
        self.keep_items(key, answer, 0, now);
    }

    /// Keeps an answer that holds so many items.
    pub(crate) fn keep_items(&mut self, key: Option<RetryKey>, answer: &A, item_count: usize, now: Instant) {
        let Some(key) = key else { return };
        while !self.by_age.is_empty() && (self.by_age.len() >= MOST || self.item_count + item_count > MOST_ITEMS) {
            self.forget_oldest();
        }
        self.item_count += item_count;
        self.by_age.push_back((now, key.id.clone()));
        self.answers.insert(key.id, Kept { content: key.content, answer: answer.clone(), item_count });
    }

    fn forget_oldest(&mut self) {
        if let Some((_, id)) = self.by_age.pop_front()
            && let Some(kept) = self.answers.remove(&id)
        {
            self.item_count -= kept.item_count;
        }
    }

    fn forget_old(&mut self, now: Instant) {
        while let Some((kept_at, _)) = self.by_age.front()
            && now.duration_since(*kept_at) > KEPT_FOR
        {
            self.forget_oldest();
        }
    }
}

#[cfg(test)]
mod tests {
    use wire::v1 as pb;

    use super::*;

    fn request(lease_s: i64) -> pb::CreateSessionRequest {
        pb::CreateSessionRequest {
            lease: Some(prost_types::Duration { seconds: lease_s, nanos: 0 }),
            ..pb::CreateSessionRequest::default()
        }
    }

    #[test]
    fn the_same_request_gets_its_answer_until_five_minutes_have_passed() {
        let mut cache = RetryCache::default();
        let start = Instant::now();
        let key = RetryKey::of("one", &request(1)).unwrap();
        cache.keep(key.clone(), &7, start);
        let soon = start + Duration::from_secs(299);
        assert_eq!(cache.find(key.as_ref(), soon).unwrap(), Some(7));
        let other = RetryKey::of("one", &request(2)).unwrap();
        cache.find(other.as_ref(), soon).unwrap_err();
        let late = start + Duration::from_secs(301);
        assert_eq!(cache.find(key.as_ref(), late).unwrap(), None);
    }

    #[test]
    fn a_request_without_an_id_is_never_kept() {
        assert!(RetryKey::of("", &request(1)).unwrap().is_none());
    }

    #[test]
    fn the_oldest_answer_goes_when_there_are_too_many() {
        let mut cache = RetryCache::default();
        let now = Instant::now();
        for number in 0..=MOST {
            cache.keep(RetryKey::of(&number.to_string(), &request(1)).unwrap(), &number, now);
        }
        let find = |cache: &mut RetryCache<usize>, id: &str| {
            cache.find(RetryKey::of(id, &request(1)).unwrap().as_ref(), now).unwrap()
        };
        assert_eq!(find(&mut cache, "0"), None);
        assert_eq!(find(&mut cache, "1"), Some(1));
        let large = RetryKey::of("large", &request(1)).unwrap();
        cache.keep_items(large, &7, MOST_ITEMS, now);
        assert_eq!((find(&mut cache, "1"), find(&mut cache, "2")), (None, Some(2)));
        cache.keep_items(RetryKey::of("one more", &request(1)).unwrap(), &8, 1, now);
        assert_eq!((find(&mut cache, "large"), find(&mut cache, "one more")), (None, Some(8)));
    }
}
