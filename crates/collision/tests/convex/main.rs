//! The convex kernels: laws, extremes, contact points.

mod contact;
mod extremes;
mod laws;
mod random;
