//! Embree 4, loaded at run time: the tracer that ours is measured against.

#![allow(unsafe_code, reason = "a C library can be called in no other way")]

mod c;

pub(crate) use c::Coherence;

use c::{Arguments, Functions, Handle, RayHit, RayHits, TraceMany, Valid};
use glam::Vec3;
use libloading::Library;
use lumel::Scene;
use lumel_accel::{Ray, SHADOW_END};
use std::path::Path;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicI64, Ordering};

/// How a tree is built.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Build {
    /// The default quality.
    Medium,
    /// The best quality and the fast triangle test.
    High,
    /// The best quality and the robust triangle test.
    Robust,
}

/// The library and a device with one thread.
pub(crate) struct Embree {
    functions: Functions,
    device: Handle,
    /// What the functions are in; closed last.
    _library: Library,
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
        // SAFETY: the initialisers of Embree and TBB have no preconditions.
        let library = unsafe { Library::new(file)? };
        let functions = Functions::of(&library)?;
        // SAFETY: the configuration ends with a zero, and the monitor needs no data of its own.
        let device = unsafe {
            let device = (functions.new_device)(c"threads=1".as_ptr());
            (functions.set_memory_monitor)(device, count_memory, null_mut());
            device
        };
        Ok(Self { functions, device, _library: library })
    }

    /// Its version, such as 4.4.0.
    pub(crate) fn version(&self) -> String {
        // SAFETY: the device is there, and the property exists in every Embree 4.
        let number = unsafe { (self.functions.device_property)(self.device, c::VERSION) };
        format!("{}.{}.{}", number / 10000, number / 100 % 100, number % 100)
    }

    /// Builds a tree over the traced triangles of a scene.
    pub(crate) fn build(&self, scene: &Scene, build: Build) -> Tree<'_> {
        let triangles = &scene.triangles()[..scene.traced_count()];
        let positions = scene.positions();
        let (flags, quality) = match build {
            Build::Medium => (0, c::MEDIUM),
            Build::High => (0, c::HIGH),
            Build::Robust => (c::ROBUST, c::HIGH),
        };
        let before = MEMORY.load(Ordering::Relaxed);
        let f = &self.functions;
        // SAFETY: Embree allocates room for as many items as are copied, of the same layout: three floats, three
        // indices. Every index is that of a vertex. The scene holds the geometry, the tree borrows the device.
        let root = unsafe {
            let geometry = (f.new_geometry)(self.device, c::TRIANGLES);
            let to = (f.new_buffer)(geometry, c::VERTEX_BUFFER, 0, c::THREE_FLOATS, 12, positions.len());
            std::ptr::copy_nonoverlapping(positions.as_ptr(), to.cast::<Vec3>(), positions.len());
            let to = (f.new_buffer)(geometry, c::INDEX_BUFFER, 0, c::THREE_INDICES, 12, triangles.len());
            std::ptr::copy_nonoverlapping(triangles.as_ptr(), to.cast::<[u32; 3]>(), triangles.len());
            (f.set_geometry_quality)(geometry, quality);
            (f.commit_geometry)(geometry);
            let root = (f.new_scene)(self.device);
            (f.set_scene_flags)(root, flags);
            (f.set_scene_quality)(root, quality);
            (f.attach)(root, geometry);
            (f.release_geometry)(geometry);
            (f.commit_scene)(root);
            root
        };
        Tree { embree: self, root, memory: MEMORY.load(Ordering::Relaxed) - before }
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
        // SAFETY: nothing uses the tree any more.
        unsafe { (self.embree.functions.release_scene)(self.root) };
    }
}

impl Tree<'_> {
    /// Distances to what the rays hit, infinite for nothing.
    pub(crate) fn distances(&self, rays: &[Ray], distances: &mut [f32]) {
        let arguments = Arguments::new(Coherence::Unknown);
        for (ray, distance) in rays.iter().zip(distances) {
            let mut hit = RayHit::new(ray.origin, ray.direction, f32::INFINITY);
            // SAFETY: all three are what rtcore.h asks for and live through the call.
            unsafe { (self.embree.functions.intersect_1)(self.root, &raw mut hit, &raw const arguments) };
            *distance = hit.t_far;
        }
    }

    /// Whether anything lies on the way of shadow rays.
    pub(crate) fn occlusions(&self, rays: &[Ray], occluded: &mut [bool]) {
        let arguments = Arguments::new(Coherence::Unknown);
        for (ray, occluded) in rays.iter().zip(occluded) {
            let mut hit = RayHit::new(ray.origin, ray.direction, SHADOW_END);
            // SAFETY: as above; `RTCRayHit` begins with the `RTCRay` that is asked for.
            unsafe { (self.embree.functions.occluded_1)(self.root, &raw mut hit, &raw const arguments) };
            *occluded = hit.t_far < 0.0;
        }
    }

    /// Tracing in packets of 8.
    pub(crate) fn by_8(&self, coherence: Coherence) -> PacketTracer<'_, 8> {
        let f = &self.embree.functions;
        PacketTracer { tree: self, intersect: f.intersect_8, occluded: f.occluded_8, coherence }
    }

    /// Tracing in packets of 16.
    pub(crate) fn by_16(&self, coherence: Coherence) -> PacketTracer<'_, 16> {
        let f = &self.embree.functions;
        PacketTracer { tree: self, intersect: f.intersect_16, occluded: f.occluded_16, coherence }
    }
}

/// The rays of `N` lanes, ready to be copied into a packet.
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
}

/// A tree whose rays are traced in packets.
pub(crate) struct PacketTracer<'a, const N: usize> {
    tree: &'a Tree<'a>,
    intersect: TraceMany<N>,
    occluded: TraceMany<N>,
    coherence: Coherence,
}

impl<const N: usize> PacketTracer<'_, N> {
    /// Distances to what the rays hit, infinite for nothing.
    pub(crate) fn distances(&self, packets: &[Lanes<N>], distances: &mut [f32]) {
        self.trace(self.intersect, f32::INFINITY, packets, |i, hits| {
            distances[i * N..][..N].copy_from_slice(&hits.t_far);
        });
    }

    /// Whether anything lies on the way of shadow rays.
    pub(crate) fn occlusions(&self, packets: &[Lanes<N>], occluded: &mut [bool]) {
        self.trace(self.occluded, SHADOW_END, packets, |i, hits| {
            let lanes = occluded[i * N..][..N].iter_mut().zip(hits.t_far);
            lanes.for_each(|(occluded, t_far)| *occluded = t_far < 0.0);
        });
    }

    fn trace(
        &self,
        function: TraceMany<N>,
        t_far: f32,
        packets: &[Lanes<N>],
        mut found: impl FnMut(usize, &RayHits<N>),
    ) {
        let (arguments, valid) = (Arguments::new(self.coherence), Valid([-1; N]));
        for (i, packet) in packets.iter().enumerate() {
            let mut hits = RayHits::new(packet.origin, packet.direction, t_far);
            // SAFETY: all four are what rtcore.h asks for, aligned to 64 bytes, and live through the call;
            // `RTCRayHitN` begins with the `RTCRayN` that occlusion asks for.
            unsafe { function(&raw const valid, self.tree.root, &raw mut hits, &raw const arguments) };
            found(i, &hits);
        }
    }
}
