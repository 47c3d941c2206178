//! Convex forms and their kernels: hulls, laws, extremes, contact points.

mod contact;
mod extremes;
mod hull;
mod laws;
mod random;
mod simplify;
mod support;
