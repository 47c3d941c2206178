//! Trees of boxes. Knows boxes and leaf numbers only, never a shape.
