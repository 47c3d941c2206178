//! Convex forms and their kernels: hulls, laws, extremes, contact points, half spaces, closed forms.

mod contact;
mod directions;
mod ellipsoid;
mod extremes;
mod found;
mod half_space;
mod half_space_ray;
mod hull;
mod laws;
mod planks;
mod points;
mod random;
mod revolved;
mod settled;
mod simplify;
mod support;
mod turning;
