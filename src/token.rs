//! Tokens: what a caller may do. A token is shown once; only its hash is kept.

use std::{collections::HashMap, fmt::Write as _};

use crate::problem::{Checked, Problem, Reason};

/// What a token allows; each role includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// Questions.
    Reader,
    /// Also edits and geometries.
    Writer,
    /// Also the calls of `SessionService`.
    Owner,
}

impl Role {
    /// As people call it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Reader => "reader",
            Self::Writer => "writer",
            Self::Owner => "owner",
        }
    }
}

/// The hash of a token. Comparing hashes tells nothing about how much of a token was right.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct TokenHash([u8; 32]);

impl std::fmt::Debug for TokenHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("TokenHash(…)")
    }
}

impl TokenHash {
    /// The hash of a token as it was sent.
    pub(crate) fn of(token: &str) -> Self {
        Self(*blake3::hash(token.as_bytes()).as_bytes())
    }
}

/// A new token: 256 random bits from the operating system, in hex.
///
/// # Errors
/// The operating system gave no randomness.
pub(crate) fn new_token() -> Checked<String> {
    random_hex(32)
}

/// `bytes` random bytes in hex.
///
/// # Errors
/// The operating system gave no randomness.
pub(crate) fn random_hex(bytes: usize) -> Checked<String> {
    let mut random = vec![0; bytes];
    getrandom::fill(&mut random).map_err(|error| {
        tracing::error!(%error, "the operating system gave no randomness");
        Problem::new(Reason::Internal, "the server's operating system gave no randomness")
    })?;
    Ok(random.iter().fold(String::new(), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    }))
}

/// The tokens of a session.
#[derive(Debug, Default)]
pub(crate) struct Tokens {
    roles: HashMap<TokenHash, Role>,
}

impl Tokens {
    /// Most tokens of one session.
    const MOST: usize = 1024;

    /// Makes a token and keeps its hash.
    ///
    /// # Errors
    /// Too many tokens, no randomness.
    pub(crate) fn create(&mut self, role: Role) -> Checked<String> {
        if self.roles.len() >= Self::MOST {
            let what =
                format!("the session has {} tokens, which is the most it may have: use one of these", Self::MOST);
            return Err(Problem::new(Reason::QuotaExceeded, what).with("quota", "tokens").with("limit", Self::MOST));
        }
        let token = new_token()?;
        self.roles.insert(TokenHash::of(&token), role);
        Ok(token)
    }

    /// What a token allows, if it is one of these.
    pub(crate) fn role_of(&self, token: &str) -> Option<Role> {
        self.roles.get(&TokenHash::of(token)).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_64_hex_digits_and_never_the_same() {
        let (one, other) = (new_token().unwrap(), new_token().unwrap());
        assert_eq!(one.len(), 64);
        assert!(one.bytes().all(|byte| byte.is_ascii_hexdigit()));
        assert_ne!(one, other);
    }

    #[test]
    fn roles_are_ordered_and_found_by_token() {
        let mut tokens = Tokens::default();
        let token = tokens.create(Role::Writer).unwrap();
        assert_eq!(tokens.role_of(&token), Some(Role::Writer));
        assert_eq!(tokens.role_of("guess"), None);
        assert!(Role::Owner > Role::Writer && Role::Writer > Role::Reader);
    }
}
