//! The part of Embree's C interface that the benchmark needs, written by hand after `embree4/rtcore.h` of 4.4.

use glam::Vec3;
use libloading::Library;
use std::ffi::{c_char, c_void};
use std::ptr::null_mut;

/// A device, geometry or scene.
pub(super) type Handle = *mut c_void;
/// `rtcIntersect1` and `rtcOccluded1`.
pub(super) type Trace = unsafe extern "C" fn(Handle, *mut RayHit, *const Arguments);
/// `rtcIntersect8`, `rtcOccluded16` and so on.
pub(super) type TraceMany<const N: usize> =
    unsafe extern "C" fn(*const Valid<N>, Handle, *mut RayHits<N>, *const Arguments);
/// `RTCMemoryMonitorFunction`.
pub(super) type MemoryMonitor = unsafe extern "C" fn(Handle, isize, bool) -> bool;

/// `RTC_DEVICE_PROPERTY_VERSION`
pub(super) const VERSION: u32 = 0;
/// `RTC_GEOMETRY_TYPE_TRIANGLE`
pub(super) const TRIANGLES: u32 = 0;
/// `RTC_BUFFER_TYPE_INDEX`
pub(super) const INDEX_BUFFER: u32 = 0;
/// `RTC_BUFFER_TYPE_VERTEX`
pub(super) const VERTEX_BUFFER: u32 = 1;
/// `RTC_FORMAT_UINT3`
pub(super) const THREE_INDICES: u32 = 0x5003;
/// `RTC_FORMAT_FLOAT3`
pub(super) const THREE_FLOATS: u32 = 0x9003;
/// `RTC_BUILD_QUALITY_MEDIUM`
pub(super) const MEDIUM: u32 = 1;
/// `RTC_BUILD_QUALITY_HIGH`
pub(super) const HIGH: u32 = 2;
/// `RTC_SCENE_FLAG_ROBUST`
pub(super) const ROBUST: u32 = 4;
/// `RTC_RAY_QUERY_FLAG_COHERENT`
const COHERENT: u32 = 1 << 16;
/// `RTC_INVALID_GEOMETRY_ID`
const NONE: u32 = u32::MAX;

/// `RTCRayHit`, with `instPrimID`, which builds with arrays of instances have.
#[repr(C, align(16))]
pub(super) struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    /// The distance to the hit; negative after an occlusion.
    pub(super) t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    triangle: u32,
    geometry: u32,
    instance: u32,
    instance_triangle: u32,
}

impl RayHit {
    pub(super) fn new(origin: Vec3, direction: Vec3, t_far: f32) -> Self {
        Self {
            origin: origin.to_array(),
            t_near: 0.0,
            direction: direction.to_array(),
            time: 0.0,
            t_far,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            triangle: NONE,
            geometry: NONE,
            instance: NONE,
            instance_triangle: NONE,
        }
    }
}

/// `RTCRayHit8` and `RTCRayHit16`; the latter wants 64 bytes of alignment, which suits the former.
#[repr(C, align(64))]
pub(super) struct RayHits<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    /// The distances to the hits; negative after an occlusion.
    pub(super) t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    u: [f32; N],
    v: [f32; N],
    triangle: [u32; N],
    geometry: [u32; N],
    instance: [u32; N],
    instance_triangle: [u32; N],
}

impl<const N: usize> RayHits<N> {
    pub(super) fn new(origin: [[f32; N]; 3], direction: [[f32; N]; 3], t_far: f32) -> Self {
        Self {
            origin,
            t_near: [0.0; N],
            direction,
            time: [0.0; N],
            t_far: [t_far; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            triangle: [NONE; N],
            geometry: [NONE; N],
            instance: [NONE; N],
            instance_triangle: [NONE; N],
        }
    }
}

/// Which rays of a packet there are: -1 for those.
#[repr(C, align(64))]
pub(super) struct Valid<const N: usize>(pub(super) [i32; N]);

/// What Embree is told about a packet.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Coherence {
    /// Nothing.
    Unknown,
    /// Its rays are much alike.
    Coherent,
}

/// `RTCIntersectArguments` and, alike as far as it is used here, `RTCOccludedArguments`.
#[repr(C)]
pub(super) struct Arguments {
    flags: u32,
    features: u32,
    context: Handle,
    filter: Handle,
    function: Handle,
    min_width_distance_factor: f32,
}

impl Arguments {
    pub(super) fn new(coherence: Coherence) -> Self {
        Self {
            flags: if matches!(coherence, Coherence::Coherent) { COHERENT } else { 0 },
            features: u32::MAX,
            context: null_mut(),
            filter: null_mut(),
            function: null_mut(),
            min_width_distance_factor: 0.0,
        }
    }
}

macro_rules! functions {
    ($($field:ident = $name:literal: $kind:ty;)*) => {
        /// The functions of a loaded library; not to be called after it is closed.
        pub(super) struct Functions { $(pub(super) $field: $kind,)* }

        impl Functions {
            pub(super) fn of(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: all names have these types in rtcore.h.
                Ok(unsafe { Self { $($field: *library.get::<$kind>($name)?,)* } })
            }
        }
    };
}

functions! {
    new_device = b"rtcNewDevice": unsafe extern "C" fn(*const c_char) -> Handle;
    device_property = b"rtcGetDeviceProperty": unsafe extern "C" fn(Handle, u32) -> isize;
    set_memory_monitor = b"rtcSetDeviceMemoryMonitorFunction": unsafe extern "C" fn(Handle, MemoryMonitor, Handle);
    new_geometry = b"rtcNewGeometry": unsafe extern "C" fn(Handle, u32) -> Handle;
    new_buffer = b"rtcSetNewGeometryBuffer":
        unsafe extern "C" fn(Handle, u32, u32, u32, usize, usize) -> *mut c_void;
    set_geometry_quality = b"rtcSetGeometryBuildQuality": unsafe extern "C" fn(Handle, u32);
    commit_geometry = b"rtcCommitGeometry": unsafe extern "C" fn(Handle);
    release_geometry = b"rtcReleaseGeometry": unsafe extern "C" fn(Handle);
    new_scene = b"rtcNewScene": unsafe extern "C" fn(Handle) -> Handle;
    set_scene_flags = b"rtcSetSceneFlags": unsafe extern "C" fn(Handle, u32);
    set_scene_quality = b"rtcSetSceneBuildQuality": unsafe extern "C" fn(Handle, u32);
    attach = b"rtcAttachGeometry": unsafe extern "C" fn(Handle, Handle) -> u32;
    commit_scene = b"rtcCommitScene": unsafe extern "C" fn(Handle);
    release_scene = b"rtcReleaseScene": unsafe extern "C" fn(Handle);
    intersect_1 = b"rtcIntersect1": Trace;
    occluded_1 = b"rtcOccluded1": Trace;
    intersect_8 = b"rtcIntersect8": TraceMany<8>;
    occluded_8 = b"rtcOccluded8": TraceMany<8>;
    intersect_16 = b"rtcIntersect16": TraceMany<16>;
    occluded_16 = b"rtcOccluded16": TraceMany<16>;
}
