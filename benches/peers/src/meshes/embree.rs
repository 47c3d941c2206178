//! Meshes and rays as Embree has them, in its robust mode: the one that is watertight. Only with the feature `embree`, which links
//! the library of the system (Debian: `libembree-dev` 3.13).
//!
//! # Safety
//! No crate binds this version, so the few functions that are needed are declared here as `embree3/rtcore.h` has them, and this is the
//! one file of the benches that calls foreign functions. Handles are made and released by [`Scene`] alone, buffers are as long as what
//! is copied into them, and rays are laid out as Embree's.

#![expect(unsafe_code, reason = "foreign functions, each with its reason")]

use std::{
    ffi::{c_char, c_int, c_uint, c_void},
    ptr,
};

use super::{
    ours::RAY_LENGTH,
    workload::{Line, Triangles},
};

const TRIANGLES: c_int = 0;
const INDICES: c_int = 0;
const VERTICES: c_int = 1;
const THREE_INTEGERS: c_int = 20483;
const THREE_FLOATS: c_int = 36867;
const ROBUST: c_int = 4;
const NOTHING: c_uint = c_uint::MAX;

/// `RTCRayHit`.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct Ray {
    origin: [f32; 3],
    first: f32,
    direction: [f32; 3],
    time: f32,
    last: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    weights: [f32; 2],
    triangle: c_uint,
    geometry: c_uint,
    instance: c_uint,
}

/// `RTCIntersectContext`.
#[repr(C)]
struct Context {
    flags: c_int,
    filter: *const c_void,
    instance: c_uint,
}

#[link(name = "embree3")]
unsafe extern "C" {
    fn rtcNewDevice(config: *const c_char) -> *mut c_void;
    fn rtcReleaseDevice(device: *mut c_void);
    fn rtcNewGeometry(device: *mut c_void, kind: c_int) -> *mut c_void;
    fn rtcSetNewGeometryBuffer(
        geometry: *mut c_void,
        kind: c_int,
        slot: c_uint,
        format: c_int,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    fn rtcCommitGeometry(geometry: *mut c_void);
    fn rtcReleaseGeometry(geometry: *mut c_void);
    fn rtcNewScene(device: *mut c_void) -> *mut c_void;
    fn rtcSetSceneFlags(scene: *mut c_void, flags: c_int);
    fn rtcAttachGeometry(scene: *mut c_void, geometry: *mut c_void) -> c_uint;
    fn rtcCommitScene(scene: *mut c_void);
    fn rtcReleaseScene(scene: *mut c_void);
    fn rtcIntersect1(scene: *mut c_void, context: *mut Context, ray: *mut Ray);
}

/// A mesh.
pub(super) struct Scene {
    device: *mut c_void,
    scene: *mut c_void,
}

impl Scene {
    /// Built by this thread alone, whose time is taken; the preset in the middle.
    pub(super) fn new(mesh: &Triangles) -> Self {
        // SAFETY: the handles are used in the order that the manual gives, and the pointers returned are to `stride * count` bytes and
        // more, into which as many are copied.
        unsafe {
            let device = rtcNewDevice(c"threads=1".as_ptr());
            let geometry = rtcNewGeometry(device, TRIANGLES);
            let buffer = rtcSetNewGeometryBuffer(geometry, VERTICES, 0, THREE_FLOATS, 12, mesh.vertices.len());
            ptr::copy_nonoverlapping(mesh.vertices.as_ptr(), buffer.cast(), mesh.vertices.len());
            let buffer = rtcSetNewGeometryBuffer(geometry, INDICES, 0, THREE_INTEGERS, 12, mesh.indices.len());
            ptr::copy_nonoverlapping(mesh.indices.as_ptr(), buffer.cast(), mesh.indices.len());
            rtcCommitGeometry(geometry);
            let scene = rtcNewScene(device);
            rtcSetSceneFlags(scene, ROBUST);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(scene);
            Self { device, scene }
        }
    }

    /// Multiples of the direction to the closest hit.
    pub(super) fn raycast(&self, ray: &Ray) -> Option<f32> {
        let mut asked = *ray;
        let mut context = Context { flags: 0, filter: ptr::null(), instance: NOTHING };
        // SAFETY: the scene is committed, and both structures are Embree's.
        unsafe { rtcIntersect1(self.scene, &raw mut context, &raw mut asked) };
        (asked.geometry != NOTHING).then_some(asked.last)
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: both are released once.
        unsafe {
            rtcReleaseScene(self.scene);
            rtcReleaseDevice(self.device);
        }
    }
}

pub(super) fn rays(lines: &[Line]) -> Vec<Ray> {
    let ray = |line: &Line| Ray {
        origin: line.origin.position,
        first: 0.0,
        direction: line.direction,
        time: 0.0,
        last: RAY_LENGTH,
        mask: c_uint::MAX,
        id: 0,
        flags: 0,
        normal: [0.0; 3],
        weights: [0.0; 2],
        triangle: NOTHING,
        geometry: NOTHING,
        instance: NOTHING,
    };
    lines.iter().map(ray).collect()
}
