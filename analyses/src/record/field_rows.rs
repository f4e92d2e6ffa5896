//! Rows of the pictures of a mesh: stress element by element, pressure and gap contact by contact, at a few instants.

use serde::Serialize;

use super::Number;

/// One element at one instant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementRow {
    /// s.
    pub time: Number,
    /// The body.
    pub body: String,
    /// From 1, over all bodies.
    pub element: usize,
    /// The middle of its nodes before the impact, m.
    pub x: Number,
    /// See `x`.
    pub y: Number,
    /// Mean stress over the element, Pa.
    pub stress_xx: Number,
    /// See `stress_xx`.
    pub stress_yy: Number,
    /// See `stress_xx`.
    pub stress_zz: Number,
    /// See `stress_xx`.
    pub stress_xy: Number,
    /// Of the mean stress, Pa.
    pub von_mises: Number,
    /// What the picture shows, Pa.
    pub shown: Number,
}

/// One contact at one instant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceRow {
    /// s.
    pub time: Number,
    /// The surface whose node it is.
    pub surface: String,
    /// From 1, in the order of the scene.
    pub contact: usize,
    /// Arc length along the surface in the plane, distance from the point that touches first in space, m.
    pub position: Number,
    /// The share of the surface that is the node's, m^2.
    pub area: Number,
    /// lambda, N, positive in compression.
    pub contact_force: Number,
    /// lambda over that share, Pa; empty where the shape functions of second order give a corner none.
    pub pressure: Option<Number>,
    /// g, m, positive in penetration.
    pub gap: Number,
}
