//! Baking in a few lines.

use crate::file_format::FileFormat;
use crate::settings::{
    Adaptive, BounceLimit, Layers, Preset, Settings, SettingsError, SettingsPatch, Share, TargetError,
};
use crate::workload::Workload;
use crate::{Baker, PointMeasurement, measure_points};
use glam::Vec3;
use lumel_basis::PointReceivers;
use lumel_export::Solution;
use lumel_scene::{FaceSide, Light, ObjectId, Scene, SceneBuilder, SceneError, Warnings};
use lumel_solve::{Observer, Silent, SolveError, SolveState, Step};
use lumel_transport::{Control, TransportError};
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Why a bake has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The scene cannot be built, or its lights are no lights.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A setting is out of bounds, or two exclude each other.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The solve was cancelled, has failed, or needs more memory than it may use.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

type OnProgress = Box<dyn Fn(Step, f64) + Send + Sync>;

/// A bake that is being set up.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use lumel::{Bake, FaceSide, Material, Preset, RectLight, SceneBuilder};
///
/// let mut scene = SceneBuilder::new("room");
/// let white = scene.add_material(Material::diffuse("white", [0.8, 0.8, 0.8]));
/// let corners = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
/// let floor = scene.add_mesh("floor", corners, [[0, 1, 2], [0, 2, 3]], white);
/// scene.add_light(RectLight::new([0.0, 2.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [9.0, 9.0, 9.0]));
///
/// let baked = Bake::new(scene).preset(Preset::Draft).bounces(4).run()?;
/// for (vertex, irradiance) in baked.light_at_vertices(floor, FaceSide::Front).iter().enumerate() {
///     println!("vertex {vertex}: {irradiance:?} W/m²");
/// }
/// # Ok(())
/// # }
/// ```
#[must_use = "nothing is baked until `run` is called"]
pub struct Bake {
    scene: Source,
    patch: SettingsPatch,
    control: Arc<Control>,
    on_progress: Option<OnProgress>,
}

enum Source {
    Builder(Box<SceneBuilder>),
    Scene(Arc<Scene>),
}

impl fmt::Debug for Bake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bake").field("settings", &self.patch).finish_non_exhaustive()
    }
}

impl Bake {
    /// A bake of a scene with the settings of [`Preset::Medium`].
    pub fn new(scene: SceneBuilder) -> Self {
        Self::of(Source::Builder(Box::new(scene)))
    }

    /// A bake of a scene that has been built.
    pub fn of_scene(scene: Arc<Scene>) -> Self {
        Self::of(Source::Scene(scene))
    }

    fn of(scene: Source) -> Self {
        Self { scene, patch: SettingsPatch::default(), control: Arc::default(), on_progress: None }
    }

    /// Settings that replace those so far, such as [`Opened::settings`](crate::Opened).
    pub fn settings(self, settings: SettingsPatch) -> Self {
        Self { patch: self.patch.overridden_by(settings), ..self }
    }

    /// Starts from a preset.
    pub fn preset(self, preset: Preset) -> Self {
        self.settings(SettingsPatch { preset: Some(preset), ..SettingsPatch::default() })
    }

    /// This many bounces after the direct light.
    pub fn bounces(self, bounces: u32) -> Self {
        self.settings(SettingsPatch {
            bounces: Some(BounceLimit::Count(bounces)),
            ..SettingsPatch::default()
        })
    }

    /// Bounces until the rest is negligible.
    pub fn all_bounces(self) -> Self {
        self.settings(SettingsPatch { bounces: Some(BounceLimit::All), ..SettingsPatch::default() })
    }

    /// Samples until 95 % of all values are known to this share of themselves: `"2%".parse()?`.
    pub fn target_error(self, error: Share) -> Self {
        let target_error = Some(TargetError::At(error));
        self.settings(SettingsPatch { target_error, ..SettingsPatch::default() })
    }

    /// Splits edges where light differs from a linear function by more than this: `"2%".parse()?`. See [`Adaptive`].
    pub fn adaptive(self, error: Share) -> Self {
        let adaptive = Some(Adaptive::At(error));
        self.settings(SettingsPatch { adaptive, ..SettingsPatch::default() })
    }

    /// Also finds the light of each light by itself: see [`Solution::layers`] and [`Baker::mixed`].
    pub fn layers(self) -> Self {
        self.settings(SettingsPatch { layers: Some(Layers::Lights), ..SettingsPatch::default() })
    }

    /// Calls this when a step begins and for every hundredth of it, from the threads that solve.
    ///
    /// It gets the step and its share that is done, from 0 to 1. A round of a target error has as many solves as it
    /// takes, and a layer as many bounces where their number is not given: their share is only 0 or 1.
    pub fn on_progress(self, on_progress: impl Fn(Step, f64) + Send + Sync + 'static) -> Self {
        Self { on_progress: Some(Box::new(on_progress)), ..self }
    }

    /// Lets another thread [cancel](Control::cancel) the bake.
    pub fn control(self, control: Arc<Control>) -> Self {
        Self { control, ..self }
    }

    /// Builds the scene and solves, on the threads of the caller's rayon pool.
    ///
    /// # Errors
    /// See [`BakeError`].
    pub fn run(self) -> Result<Baked, BakeError> {
        let settings = self.patch.settings();
        settings.validate()?;
        let (scene, warnings) = match self.scene {
            Source::Builder(builder) => {
                builder.build().map(|(scene, warnings)| (Arc::new(scene), warnings))?
            }
            Source::Scene(scene) => (scene, Warnings::default()),
        };
        let baker = Baker::new(scene, settings);
        let adapted = baker.adapted(&self.control, &mut |_| {})?;
        let baker = adapted.map_or(baker, |adapted| adapted.baker);
        Baked::solve(baker, warnings, &self.control, self.on_progress.as_ref())
    }
}

/// A finished bake.
pub struct Baked {
    baker: Baker,
    state: SolveState,
    warnings: Warnings,
}

impl fmt::Debug for Baked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Baked").field("scene", &self.baker.scene().name()).finish_non_exhaustive()
    }
}

impl Baked {
    fn solve(
        baker: Baker,
        warnings: Warnings,
        control: &Control,
        on_progress: Option<&OnProgress>,
    ) -> Result<Self, BakeError> {
        let mut state = SolveState::new();
        match on_progress {
            Some(on_progress) => {
                let watch = Watch::new(&baker, control, on_progress);
                baker.run(&mut state, control, &watch)?;
            }
            None => baker.run(&mut state, control, &Silent)?,
        }
        Ok(Self { baker, state, warnings })
    }

    /// What had to be left out of the scene.
    pub fn warnings(&self) -> &Warnings {
        &self.warnings
    }

    /// Irradiance at the vertices of a mesh as they were given, W·m⁻², on one side of its faces.
    ///
    /// `None` where no light is stored: at vertices that no kept face uses, and on the back of one-sided faces. At a
    /// crease or the edge of a wall, where neighbouring faces have light of their own, it is the mean by the angle that
    /// they take up around the vertex; [`light_at_corners`](Self::light_at_corners) tells them apart.
    ///
    /// # Panics
    /// If the scene has no such mesh.
    pub fn light_at_vertices(&self, mesh: ObjectId, side: FaceSide) -> Vec<Option<Vec3>> {
        let light = self.at_scene_vertices();
        let map = self.baker.scene().input_mesh(mesh).vertex_map(side);
        map.mean(|vertex| light[vertex as usize])
    }

    /// Irradiance at the three corners of each face of a mesh as they were given, W·m⁻², on one side.
    ///
    /// `None` for faces that were dropped, and for the back of one-sided ones.
    ///
    /// # Panics
    /// If the scene has no such mesh.
    pub fn light_at_corners(&self, mesh: ObjectId, side: FaceSide) -> Vec<Option<[Vec3; 3]>> {
        let light = self.at_scene_vertices();
        let input = self.baker.scene().input_mesh(mesh);
        let corners = |face| input.corners(face, side).map(|corners| corners.map(|v| light[v as usize]));
        (0..input.face_count()).map(corners).collect()
    }

    fn at_scene_vertices(&self) -> Vec<Vec3> {
        self.baker.light_at_vertices(&self.state)
    }

    /// Irradiance at points with normals, with its standard error, by fresh rays.
    ///
    /// # Errors
    /// When tracing fails.
    pub fn measure(&self, points: &PointReceivers) -> Result<PointMeasurement, TransportError> {
        measure_points(&self.baker, &self.state, points, &Control::default())
    }

    /// The same surfaces under other lights: the ray tracer and stored rays are used again, so that it takes little more
    /// time than direct light.
    ///
    /// # Errors
    /// Lights that [`SceneBuilder::build`] would refuse, and what a bake meets.
    pub fn relit(&self, lights: Vec<Light>) -> Result<Self, BakeError> {
        let scene = Arc::new(self.baker.scene().relit(lights)?);
        let baker = self.baker.relit(scene, self.baker.settings().clone());
        Self::solve(baker, Warnings::default(), &Control::default(), None)
    }

    /// The light at every vertex of the scene, bounce by bounce, for files.
    pub fn solution(&self) -> Solution {
        self.baker.solution(&self.state)
    }

    /// Writes the light or the lit mesh; the extension tells the [format](FileFormat).
    ///
    /// # Errors
    /// An unknown extension, and all that writing meets.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), crate::SaveError> {
        let path = path.as_ref();
        FileFormat::of(path)?.write(path, self.baker.scene(), &self.solution())
    }

    /// The scene, with everything that was baked in it.
    pub fn baker(&self) -> &Baker {
        &self.baker
    }

    /// What the solve has found.
    pub fn state(&self) -> &SolveState {
        &self.state
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        self.baker.settings()
    }
}

/// Calls back for every hundredth of a step.
struct Watch<'a> {
    control: &'a Control,
    on_progress: &'a OnProgress,
    workload: Workload,
    step: std::sync::Mutex<Option<(Step, u64)>>,
    /// Hundredths of the current step that were told.
    told: AtomicU32,
}

impl<'a> Watch<'a> {
    fn new(baker: &Baker, control: &'a Control, on_progress: &'a OnProgress) -> Self {
        let workload = Workload::new(baker);
        Self { control, on_progress, workload, step: Default::default(), told: AtomicU32::new(0) }
    }

    fn step(&self) -> std::sync::MutexGuard<'_, Option<(Step, u64)>> {
        self.step.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Observer for Watch<'_> {
    fn step_started(&self, step: Step) {
        *self.step() = Some((step, self.control.elements()));
        self.told.store(0, Ordering::Relaxed);
        (self.on_progress)(step, 0.0);
    }

    fn step_done(&self, step: Step, _: &SolveState) {
        (self.on_progress)(step, 1.0);
    }

    /// Asked after every chunk, which makes it the place to look; no snapshot is wanted.
    fn wants_snapshot(&self) -> bool {
        let Some((step, begun)) = *self.step() else { return false };
        let done = self.control.elements().saturating_sub(begun);
        if let Some(share) = self.workload.step_share(step, done, &[]) {
            let hundredths = ((100.0 * share) as u32).min(99);
            if self.told.fetch_max(hundredths, Ordering::Relaxed) < hundredths {
                (self.on_progress)(step, f64::from(hundredths) / 100.0);
            }
        }
        false
    }
}
