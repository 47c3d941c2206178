//! Convex forms and their kernels: hulls, laws, extremes, contact points, half spaces.

mod contact;
mod extremes;
mod half_space;
mod half_space_ray;
mod hull;
mod laws;
mod planks;
mod random;
mod simplify;
mod support;
mod turning;
