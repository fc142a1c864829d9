//! Embree 4, loaded at run time: the tracer that ours is measured against.
//!
//! Only what the benchmark needs of its C interface, written by hand after `embree4/rtcore.h` of 4.4.

#![allow(unsafe_code, reason = "a C library can be called in no other way")]

use glam::Vec3;
use libloading::Library;
use lumel::Scene;
use lumel_accel::{Ray, SHADOW_END};
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicI64, Ordering};

type Handle = *mut c_void;
type Intersect = unsafe extern "C" fn(Handle, *mut RayHit, *const Arguments);
type IntersectMany<const N: usize> =
    unsafe extern "C" fn(*const Valid<N>, Handle, *mut RayHits<N>, *const Arguments);

/// `RTC_INVALID_GEOMETRY_ID`.
const NONE: u32 = u32::MAX;

/// `RTCRayHit`, with `instPrimID`, which the builds of 4.4 have.
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
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
    fn new(origin: Vec3, direction: Vec3, t_far: f32) -> Self {
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
#[derive(Clone)]
struct RayHits<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    t_far: [f32; N],
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

/// Which rays of a packet there are: -1 for those.
#[repr(C, align(64))]
struct Valid<const N: usize>([i32; N]);

/// `RTCIntersectArguments` and, alike so far as we use it, `RTCOccludedArguments`.
#[repr(C)]
struct Arguments {
    flags: u32,
    features: u32,
    context: Handle,
    filter: Handle,
    function: Handle,
    min_width_distance_factor: f32,
}

impl Arguments {
    fn new(coherence: Coherence) -> Self {
        let flags = match coherence {
            Coherence::Unknown => 0,
            // RTC_RAY_QUERY_FLAG_COHERENT
            Coherence::Coherent => 1 << 16,
        };
        Self {
            flags,
            features: u32::MAX,
            context: null_mut(),
            filter: null_mut(),
            function: null_mut(),
            min_width_distance_factor: 0.0,
        }
    }
}

/// What Embree is told about a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coherence {
    /// Nothing.
    Unknown,
    /// Its rays are much alike.
    Coherent,
}

/// How a tree is built.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Build {
    /// The default quality.
    Medium,
    /// The best quality and the fast triangle test.
    High,
    /// The best quality and the robust triangle test.
    HighRobust,
}

/// The rays of `N` lanes, ready to be copied into a packet.
#[derive(Clone)]
pub(crate) struct Lanes<const N: usize> {
    origin: [[f32; N]; 3],
    direction: [[f32; N]; 3],
}

impl<const N: usize> Lanes<N> {
    /// Packs rays whose number is a multiple of `N`.
    pub(crate) fn pack(rays: &[Ray]) -> Vec<Self> {
        let packet = |rays: &[Ray]| Self {
            origin: std::array::from_fn(|axis| std::array::from_fn(|lane| rays[lane].origin[axis])),
            direction: std::array::from_fn(|axis| std::array::from_fn(|lane| rays[lane].direction[axis])),
        };
        rays.chunks_exact(N).map(packet).collect()
    }

    fn to_hits(&self, t_far: f32) -> RayHits<N> {
        RayHits {
            origin: self.origin,
            t_near: [0.0; N],
            direction: self.direction,
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

/// The library and a device with one thread.
pub(crate) struct Embree {
    library: Library,
    device: Handle,
    intersect_1: Intersect,
    occluded_1: Intersect,
    intersect_8: IntersectMany<8>,
    occluded_8: IntersectMany<8>,
    intersect_16: IntersectMany<16>,
    occluded_16: IntersectMany<16>,
}

/// Bytes that Embree holds at the moment.
static MEMORY: AtomicI64 = AtomicI64::new(0);

unsafe extern "C" fn count_memory(_: Handle, bytes: isize, _: bool) -> bool {
    MEMORY.fetch_add(bytes as i64, Ordering::Relaxed);
    true
}

impl Embree {
    /// Loads the library from a file.
    pub(crate) fn load(file: &Path) -> Result<Self, libloading::Error> {
        // SAFETY: the initialisers of Embree and TBB have no preconditions. All names are looked up with their types
        // in rtcore.h; the pointers live no longer than the library, which this struct holds.
        unsafe {
            let library = Library::new(file)?;
            let new_device: unsafe extern "C" fn(*const c_char) -> Handle = *library.get(b"rtcNewDevice")?;
            let set_monitor: unsafe extern "C" fn(
                Handle,
                unsafe extern "C" fn(Handle, isize, bool) -> bool,
                Handle,
            ) = *library.get(b"rtcSetDeviceMemoryMonitorFunction")?;
            let device = new_device(c"threads=1".as_ptr());
            set_monitor(device, count_memory, null_mut());
            Ok(Self {
                device,
                intersect_1: *library.get(b"rtcIntersect1")?,
                occluded_1: *library.get(b"rtcOccluded1")?,
                intersect_8: *library.get(b"rtcIntersect8")?,
                occluded_8: *library.get(b"rtcOccluded8")?,
                intersect_16: *library.get(b"rtcIntersect16")?,
                occluded_16: *library.get(b"rtcOccluded16")?,
                library,
            })
        }
    }

    /// Its version, as 40400 for 4.4.0.
    pub(crate) fn version(&self) -> isize {
        // SAFETY: the name and its type are those of rtcore.h; 0 is RTC_DEVICE_PROPERTY_VERSION.
        unsafe {
            let property: libloading::Symbol<'_, unsafe extern "C" fn(Handle, u32) -> isize> =
                self.library.get(b"rtcGetDeviceProperty").expect("every Embree 4 has properties");
            property(self.device, 0)
        }
    }

    /// Builds a tree over the traced triangles of a scene.
    pub(crate) fn build(&self, scene: &Scene, build: Build) -> Result<Tree<'_>, libloading::Error> {
        let triangles = &scene.triangles()[..scene.traced_count()];
        let (flags, quality) = match build {
            Build::Medium => (0, 1),
            Build::High => (0, 2),
            Build::HighRobust => (4, 2),
        };
        let before = MEMORY.load(Ordering::Relaxed);
        // SAFETY: names and types are those of rtcore.h. The buffers that Embree allocates have room for as many items
        // as are copied, of the same layout: three floats and three indices. Every index is that of a vertex. What is
        // attached or committed stays alive by Embree's own reference counts; the tree borrows the device.
        let root = unsafe {
            let l = &self.library;
            let new_geometry: unsafe extern "C" fn(Handle, u32) -> Handle = *l.get(b"rtcNewGeometry")?;
            let new_buffer: unsafe extern "C" fn(Handle, u32, u32, u32, usize, usize) -> *mut c_void =
                *l.get(b"rtcSetNewGeometryBuffer")?;
            let geometry_quality: unsafe extern "C" fn(Handle, u32) =
                *l.get(b"rtcSetGeometryBuildQuality")?;
            let commit_geometry: unsafe extern "C" fn(Handle) = *l.get(b"rtcCommitGeometry")?;
            let release_geometry: unsafe extern "C" fn(Handle) = *l.get(b"rtcReleaseGeometry")?;
            let new_scene: unsafe extern "C" fn(Handle) -> Handle = *l.get(b"rtcNewScene")?;
            let scene_flags: unsafe extern "C" fn(Handle, u32) = *l.get(b"rtcSetSceneFlags")?;
            let scene_quality: unsafe extern "C" fn(Handle, u32) = *l.get(b"rtcSetSceneBuildQuality")?;
            let attach: unsafe extern "C" fn(Handle, Handle) -> u32 = *l.get(b"rtcAttachGeometry")?;
            let commit_scene: unsafe extern "C" fn(Handle) = *l.get(b"rtcCommitScene")?;

            const TRIANGLES: u32 = 0;
            const INDEX_BUFFER: u32 = 0;
            const VERTEX_BUFFER: u32 = 1;
            const THREE_INDICES: u32 = 0x5003;
            const THREE_FLOATS: u32 = 0x9003;
            let geometry = new_geometry(self.device, TRIANGLES);
            let positions = scene.positions();
            let to = new_buffer(geometry, VERTEX_BUFFER, 0, THREE_FLOATS, 12, positions.len());
            std::ptr::copy_nonoverlapping(positions.as_ptr(), to.cast::<Vec3>(), positions.len());
            let to = new_buffer(geometry, INDEX_BUFFER, 0, THREE_INDICES, 12, triangles.len());
            std::ptr::copy_nonoverlapping(triangles.as_ptr(), to.cast::<[u32; 3]>(), triangles.len());
            geometry_quality(geometry, quality);
            commit_geometry(geometry);
            let root = new_scene(self.device);
            scene_flags(root, flags);
            scene_quality(root, quality);
            attach(root, geometry);
            release_geometry(geometry);
            commit_scene(root);
            root
        };
        let memory = MEMORY.load(Ordering::Relaxed) - before;
        Ok(Tree { embree: self, root, memory })
    }
}

/// A built tree.
pub(crate) struct Tree<'a> {
    embree: &'a Embree,
    root: Handle,
    /// Bytes it holds, copies of the vertices and indices included.
    pub(crate) memory: i64,
}

impl Drop for Tree<'_> {
    fn drop(&mut self) {
        // SAFETY: the name and its type are those of rtcore.h, and nothing uses the tree any more.
        unsafe {
            let release: Result<libloading::Symbol<'_, unsafe extern "C" fn(Handle)>, _> =
                self.embree.library.get(b"rtcReleaseScene");
            if let Ok(release) = release {
                release(self.root);
            }
        }
    }
}

impl Tree<'_> {
    /// Distances to what the rays hit, infinite for nothing.
    pub(crate) fn distances(&self, rays: &[Ray], distances: &mut [f32]) {
        let arguments = Arguments::new(Coherence::Unknown);
        for (ray, distance) in rays.iter().zip(distances) {
            let mut hit = RayHit::new(ray.origin, ray.direction, f32::INFINITY);
            // SAFETY: all three are what rtcore.h asks for and live through the call.
            unsafe { (self.embree.intersect_1)(self.root, &raw mut hit, &raw const arguments) };
            *distance = hit.t_far;
        }
    }

    /// Whether anything lies on the way of shadow rays.
    pub(crate) fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) {
        let arguments = Arguments::new(Coherence::Unknown);
        for (ray, occluded) in rays.iter().zip(occluded) {
            let mut hit = RayHit::new(ray.origin, ray.direction, SHADOW_END);
            // SAFETY: as above; `RTCRayHit` begins with the `RTCRay` that is asked for.
            unsafe { (self.embree.occluded_1)(self.root, &raw mut hit, &raw const arguments) };
            *occluded = hit.t_far < 0.0;
        }
    }

    /// Distances in packets of 8 or 16.
    pub(crate) fn distances_of<const N: usize>(
        &self,
        packets: &[Lanes<N>],
        coherence: Coherence,
        distances: &mut [f32],
    ) where
        Self: Packets<N>,
    {
        self.trace(packets, (self.intersect(), f32::INFINITY), coherence, |i, hits| {
            distances[i * N..][..N].copy_from_slice(&hits.t_far);
        });
    }

    /// Occlusions in packets of 8 or 16.
    pub(crate) fn occlusions_of<const N: usize>(
        &self,
        packets: &[Lanes<N>],
        coherence: Coherence,
        occluded: &mut [bool],
    ) where
        Self: Packets<N>,
    {
        self.trace(packets, (self.occluded(), SHADOW_END), coherence, |i, hits| {
            for (occluded, t_far) in occluded[i * N..][..N].iter_mut().zip(hits.t_far) {
                *occluded = t_far < 0.0;
            }
        });
    }

    fn trace<const N: usize>(
        &self,
        packets: &[Lanes<N>],
        (function, t_far): (IntersectMany<N>, f32),
        coherence: Coherence,
        mut found: impl FnMut(usize, &RayHits<N>),
    ) {
        let (arguments, valid) = (Arguments::new(coherence), Valid([-1; N]));
        for (i, packet) in packets.iter().enumerate() {
            let mut hits = packet.to_hits(t_far);
            // SAFETY: all four are what rtcore.h asks for, aligned to 64 bytes, and live through the call;
            // `RTCRayHitN` begins with the `RTCRayN` that occlusion asks for.
            unsafe { function(&raw const valid, self.root, &raw mut hits, &raw const arguments) };
            found(i, &hits);
        }
    }
}

/// The functions for packets of one size.
pub(crate) trait Packets<const N: usize> {
    #[allow(private_interfaces, reason = "nobody but this file calls it")]
    fn intersect(&self) -> IntersectMany<N>;
    #[allow(private_interfaces, reason = "nobody but this file calls it")]
    fn occluded(&self) -> IntersectMany<N>;
}

#[allow(private_interfaces, reason = "nobody but this file calls it")]
impl Packets<8> for Tree<'_> {
    fn intersect(&self) -> IntersectMany<8> {
        self.embree.intersect_8
    }
    fn occluded(&self) -> IntersectMany<8> {
        self.embree.occluded_8
    }
}

#[allow(private_interfaces, reason = "nobody but this file calls it")]
impl Packets<16> for Tree<'_> {
    fn intersect(&self) -> IntersectMany<16> {
        self.embree.intersect_16
    }
    fn occluded(&self) -> IntersectMany<16> {
        self.embree.occluded_16
    }
}
