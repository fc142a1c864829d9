//! What a bake reports.

use crate::command_run::{AdaptiveReport, SolveLog};
use crate::report::{self, counted};
use lumel::{
    Accuracy, Adaptive, Baker, Ended, ErrorCause, ErrorEstimate, LumelAccuracy, Memory, Settings, Solution,
    SolveState,
};
use serde::Serialize;
use std::path::PathBuf;

/// The result of a bake in numbers.
#[derive(Debug, Serialize)]
pub(crate) struct Summary {
    scene: String,
    vertices: usize,
    triangles: usize,
    /// The longest edge that `--max-edge auto` chose, if it split any, metres.
    pub(crate) auto_edge: Option<f32>,
    /// How the mesh was refined, if it follows light.
    pub(crate) adaptive: Option<AdaptiveReport>,
    /// The points that carried light from bounce to bounce, if these were not the vertices.
    points: Option<PointReport>,
    /// Vertices that could not be measured.
    invalid_vertices: usize,
    /// How the bounces were solved.
    method: String,
    /// Direct light and all bounces.
    steps: Vec<StepReport>,
    /// Bounces from the checkpoint, direct light included.
    pub(crate) resumed_bounces: usize,
    /// Fraction of all light that was not computed.
    remainder: Option<f64>,
    /// What that is.
    #[serde(skip)]
    remainder_in: &'static str,
    /// Whether an estimate of the remainder was added.
    tail: bool,
    /// What the error is about, where it was not measured.
    estimate: Option<EstimateReport>,
    /// The accuracy of a bake with a target error.
    error: Option<ErrorReport>,
    rays: u64,
    mrays_per_second: f64,
    threads: usize,
    /// The lightmap, if light is stored in one.
    lightmap: Option<LightmapReport>,
    pub(crate) memory: MemoryReport,
    pub(crate) seconds: Seconds,
    pub(crate) files: Vec<Written>,
    pub(crate) warnings: usize,
}

/// Points that carried light from bounce to bounce.
#[derive(Debug, Serialize)]
pub(crate) struct PointReport {
    points: usize,
    levels: u32,
    /// Points that were not measured: those inside geometry, and those of levels that follow light where it has no detail.
    invalid: usize,
    /// Whether levels follow light.
    adaptive: bool,
    /// Metres.
    spacing: f32,
}

impl PointReport {
    fn of(baker: &Baker, state: &SolveState) -> Option<Self> {
        let basis = baker.basis().points()?;
        let invalid = state.valid.iter().filter(|valid| !**valid).count();
        let (levels, spacing) = (basis.level_count(), basis.spacing());
        let adaptive = baker.settings().adaptive != Adaptive::Off;
        Some(Self { points: basis.points().len(), levels, invalid, adaptive, spacing })
    }

    fn text(&self) -> String {
        let points = counted(self.points, "point", "points");
        let spacing = report::significant(f64::from(self.spacing));
        let inside = match self.invalid {
            0 => String::new(),
            n if self.adaptive => format!(", {} of them measured", self.points - n),
            n => format!(", {n} of them inside geometry"),
        };
        let levels = match self.levels {
            1 => String::new(),
            n => format!(" on {n} levels"),
        };
        format!("{points}{levels} carried the bounces, {spacing} m from each other{inside}")
    }
}

/// What the program takes of memory, bytes, where the system tells.
#[derive(Debug, Default, Serialize)]
pub(crate) struct MemoryReport {
    /// What was said before the solve.
    pub(crate) announced: Option<Memory>,
    /// The most that it took.
    pub(crate) peak: Option<Memory>,
}

impl MemoryReport {
    fn text(&self) -> Option<String> {
        let Self { announced, peak } = self;
        Some(format!("memory {} at most, announced {}", (*peak)?, (*announced)?))
    }
}

/// A lightmap.
#[derive(Debug, Serialize)]
pub(crate) struct LightmapReport {
    pub(crate) pages: Vec<[u32; 2]>,
    /// Lumels with light of their own.
    pub(crate) lumels: usize,
    /// Lumels that see nothing but the inside of geometry.
    pub(crate) invalid_lumels: usize,
    /// Lumels per metre.
    pub(crate) density: f32,
    pub(crate) noise: NoiseReport,
    pub(crate) charts: usize,
    pub(crate) utilization: f64,
    /// Objects whose lightmap coordinates are kept.
    pub(crate) kept: usize,
    /// Whether all of them are, on a square that they share.
    pub(crate) shared: bool,
    /// What the rays take that are kept at a time.
    pub(crate) ray_bytes: Memory,
    pub(crate) unwrap_seconds: f64,
    /// For measuring light in lumels.
    pub(crate) seconds: f64,
    pub(crate) finish_seconds: f64,
}

/// How noisy the light in lumels is before it is denoised: half the widths of 95 % intervals, relative.
#[derive(Debug, Serialize)]
pub(crate) struct NoiseReport {
    median: f64,
    percentile_95: f64,
    /// Share of lumels below the target error.
    #[serde(skip_serializing_if = "Option::is_none")]
    share: Option<f64>,
}

impl From<LumelAccuracy> for NoiseReport {
    fn from(LumelAccuracy { median, percentile_95, share }: LumelAccuracy) -> Self {
        Self { median, percentile_95, share }
    }
}

impl NoiseReport {
    fn text(&self) -> String {
        let [median, percentile_95] = [self.median, self.percentile_95].map(report::percent);
        let share = self.share.map(|share| format!("; {} are within the target", report::percent(share)));
        format!(
            "noise of lumels, 95 % interval: half are within {median}, 95 % within {percentile_95}{}",
            share.unwrap_or_default()
        )
    }
}

impl LightmapReport {
    fn text(&self) -> String {
        let sizes: Vec<String> = self.pages.iter().map(|[w, h]| format!("{w} x {h}")).collect();
        let pages = counted(self.pages.len(), "page", "pages");
        let inside = match self.invalid_lumels {
            0 => String::new(),
            n => format!(", {} inside geometry", counted(n, "lies", "lie")),
        };
        let kept = match (self.shared, self.kept) {
            (true, _) => {
                "\nthe lightmap coordinates of all objects are kept, on the square that they share".to_owned()
            }
            (false, 0) => String::new(),
            (false, n) => {
                format!("\nthe lightmap coordinates of {} are kept", counted(n, "object", "objects"))
            }
        };
        format!(
            "lightmap {pages} of {}, {} used by {}; {} of {} per metre{inside}{kept}\n{}\nunwrap {:.2} s\nlumels {:.2} s, rays stored part by part ({})\nfinish {:.2} s",
            sizes.join(", "),
            report::percent(self.utilization),
            counted(self.charts, "chart", "charts"),
            counted(self.lumels, "lumel", "lumels"),
            report::significant(f64::from(self.density)),
            self.noise.text(),
            self.unwrap_seconds,
            self.seconds,
            self.ray_bytes,
            self.finish_seconds,
        )
    }
}

/// Times by phase.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Seconds {
    pub(crate) load: f64,
    pub(crate) build: f64,
    solve: f64,
    checkpoints: f64,
    pub(crate) write: f64,
    pub(crate) total: f64,
}

/// A file that was written.
#[derive(Debug, Serialize)]
pub(crate) struct Written {
    pub(crate) path: PathBuf,
    pub(crate) bytes: u64,
}

/// A step of the solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// Finding vertices inside geometry.
    Validity,
    /// A bounce; 0 is direct light.
    Bounce(usize),
    /// A batch of vertices that have sent their light.
    Shot(u32),
    /// A final gather of all indirect light.
    FinalGather,
    /// Direct light at vertices, where points carry the bounces.
    ReadDirect,
    Directional,
    /// More samples where the error is above the target.
    Round(u32),
    /// Measuring the light of some emitters alone.
    Layer(u32),
}

#[derive(Debug, Serialize)]
struct StepReport {
    step: String,
    /// `None` for a step from the checkpoint.
    seconds: Option<f64>,
    /// Share of the light of all bounces.
    share: Option<f64>,
    /// Whether this is part of the rounds, which have the seconds.
    #[serde(skip)]
    in_rounds: bool,
}

/// The accuracy of a bake with a target error. Errors are half the widths of 95 % intervals, relative.
#[derive(Debug, Serialize)]
struct ErrorReport {
    target: f64,
    target_share: f64,
    /// Whether enough values meet the target.
    reached: bool,
    /// Why there were no more samples: "reached", "samples" or "memory".
    ended: &'static str,
    rounds: u32,
    /// Share of values below the target, by the spread of each and its neighbours.
    share: f64,
    /// The same by its own spread alone.
    own_share: f64,
    median: f64,
    worst: f64,
}

impl ErrorReport {
    fn new(accuracy: &Accuracy) -> Self {
        let Accuracy { target, share, own_share, median, worst, rounds, ended } = *accuracy;
        let ended = match ended {
            Some(Ended::Reached) => "reached",
            Some(Ended::Memory) => "memory",
            Some(Ended::Samples) | None => "samples",
        };
        Self {
            target: target.error,
            target_share: target.share,
            reached: ended == "reached",
            ended,
            rounds,
            share,
            own_share,
            median,
            worst,
        }
    }

    fn text(&self) -> [String; 2] {
        let [share, target, wanted] = [self.share, self.target, self.target_share].map(report::percent);
        let [median, worst] = [self.median, self.worst].map(report::percent);
        let missed = if self.reached { "" } else { "; not reached" };
        [
            format!("accuracy: {share} of values are within {target} (target: {wanted}{missed})"),
            format!("half-width of the 95 % interval, relative: median {median}, maximum {worst}"),
        ]
    }
}

/// From this factor on, the darker half of the surfaces has an error of its own in the summary.
const MUCH_WORSE: f64 = 5.0;

/// An estimated error, relative.
#[derive(Debug, Serialize)]
struct EstimateReport {
    error: f64,
    /// Of the light on the darker half of the surfaces alone.
    in_darker_half: Option<f64>,
    cause: &'static str,
    /// The option that lowers it.
    remedy: &'static str,
}

impl EstimateReport {
    fn new(ErrorEstimate { error, in_darker_half, cause }: ErrorEstimate, settings: &Settings) -> Self {
        let (cause, remedy) = match cause {
            ErrorCause::DirectNoise => ("noise of direct light", "--direct-samples"),
            ErrorCause::IndirectNoise => ("noise of bounces", "--indirect-samples"),
            ErrorCause::CoarseMesh if settings.adaptive != Adaptive::Off => {
                ("edges of light between vertices", "--adaptive")
            }
            ErrorCause::CoarseMesh => ("edges of light between vertices", "--max-edge"),
        };
        Self { error, in_darker_half, cause, remedy }
    }
}

impl EstimateReport {
    fn text(&self) -> String {
        let more = match self.remedy {
            "--max-edge" => "a shorter",
            "--adaptive" => "a smaller",
            _ => "more",
        };
        let error = report::percent(self.error);
        let is_worse = |darker: &f64| *darker > MUCH_WORSE * self.error;
        let darker = self.in_darker_half.filter(is_worse).map_or_else(String::new, |darker| {
            format!(" and {} of that on their darker half", report::percent(darker))
        });
        format!(
            "error about {error} of the light on all surfaces{darker}, most of it {}: {more} {} lowers it",
            self.cause, self.remedy
        )
    }
}

impl From<lumel::Step> for Step {
    fn from(step: lumel::Step) -> Self {
        match step {
            lumel::Step::Validity => Self::Validity,
            lumel::Step::Bounce(bounce) => Self::Bounce(bounce as usize),
            lumel::Step::Shot(shot) => Self::Shot(shot),
            lumel::Step::FinalGather => Self::FinalGather,
            lumel::Step::ReadDirect => Self::ReadDirect,
            lumel::Step::Directional => Self::Directional,
            lumel::Step::Round(round) => Self::Round(round),
            lumel::Step::Layer(layer) => Self::Layer(layer),
        }
    }
}

impl Step {
    /// The name in reports and files.
    pub(crate) fn key(self) -> String {
        match self {
            Self::Validity => "validity".to_owned(),
            Self::Bounce(0) => "direct".to_owned(),
            Self::Bounce(k) => format!("bounce {k}"),
            Self::Shot(shot) => format!("shot {}", shot + 1),
            Self::FinalGather => "final gather".to_owned(),
            Self::ReadDirect => "direct at vertices".to_owned(),
            Self::Directional => "directional".to_owned(),
            Self::Round(round) => format!("round {}", round + 1),
            Self::Layer(layer) => format!("layer {}", layer + 1),
        }
    }
}

impl Summary {
    /// The summary of a solve.
    pub(crate) fn new(
        baker: &Baker,
        state: &SolveState,
        solution: &Solution,
        rays: u64,
        log: &SolveLog,
    ) -> Self {
        let scene = baker.scene();
        let seconds_of = |wanted: Step| {
            log.steps.iter().find(|(step, _)| Step::from(*step) == wanted).map(|(_, seconds)| *seconds)
        };
        let in_rounds = state.errors.is_some();
        let estimate = if in_rounds { None } else { baker.error_estimate(solution) };
        let report =
            |step: Step, share| StepReport { step: step.key(), seconds: seconds_of(step), share, in_rounds };
        let validity = seconds_of(Step::Validity).map(|_| report(Step::Validity, None));
        let shares = baker.shares(state).into_iter().enumerate();
        let mut bounces = shares.map(|(k, share)| report(Step::Bounce(k), Some(share)));
        let shots = shots_report(baker, state, log);
        let rounds = state.errors.as_ref().map_or(0, |errors| errors.accuracy.rounds);
        let rounds = (0..rounds).map(|round| report(Step::Round(round), None));
        let layers = (0..state.layers.len() as u32).map(|layer| report(Step::Layer(layer), None));
        let finishers = [Step::FinalGather, Step::ReadDirect, Step::Directional];
        let finished = |step: Step| seconds_of(step).map(|_| report(step, None));
        let [gather, read_direct, directional] = finishers.map(finished);
        Self {
            scene: scene.name().to_owned(),
            vertices: scene.vertex_count(),
            triangles: scene.triangle_count(),
            auto_edge: None,
            adaptive: None,
            points: PointReport::of(baker, state),
            invalid_vertices: solution.valid.iter().filter(|&&valid| !valid).count(),
            method: baker.method().to_string(),
            steps: validity
                .into_iter()
                .chain(bounces.next())
                .chain(read_direct)
                .chain(bounces)
                .chain(shots)
                .chain(gather)
                .chain(rounds)
                .chain(directional)
                .chain(layers)
                .collect(),
            resumed_bounces: 0,
            remainder: baker.remainder(state),
            remainder_in: if state.shot.is_some() { "what is unshot" } else { "further bounces" },
            tail: state.tail.is_some(),
            estimate: estimate.map(|estimate| EstimateReport::new(estimate, baker.settings())),
            error: state.errors.as_ref().map(|errors| ErrorReport::new(&errors.accuracy)),
            rays,
            mrays_per_second: 1e-6 * rays as f64 / log.seconds.max(1e-9),
            threads: rayon::current_num_threads(),
            seconds: Seconds {
                solve: log.seconds,
                checkpoints: log.checkpoint_seconds,
                ..Seconds::default()
            },
            lightmap: None,
            memory: MemoryReport::default(),
            files: Vec::new(),
            warnings: 0,
        }
    }

    /// Adds a lightmap, whose rays are among those of the summary.
    pub(crate) fn add_lightmap(&mut self, report: LightmapReport) {
        let seconds = self.seconds.solve + report.seconds;
        self.mrays_per_second = 1e-6 * self.rays as f64 / seconds.max(1e-9);
        self.lightmap = Some(report);
    }

    /// One JSON object on a line.
    pub(crate) fn json(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Lines for people; one is exactly `solve 1.23 s`.
    pub(crate) fn text(&self) -> String {
        let vertices = counted(self.vertices, "vertex", "vertices");
        let triangles = counted(self.triangles, "triangle", "triangles");
        let edges = self.auto_edge.map_or_else(String::new, |edge| {
            format!("; edges split to at most {} m (--max-edge auto)", report::significant(f64::from(edge)))
        });
        let mut lines = vec![format!("scene {}: {vertices}, {triangles}{edges}", self.scene)];
        lines.extend(self.adaptive.as_ref().map(
            |AdaptiveReport { error, given_vertices, reached, seconds }| {
                let given = counted(*given_vertices, "vertex", "vertices");
                let error = report::percent(f64::from(*error));
                let end = if *reached { "" } else { ", as far as --max-vertices allows" };
                format!("mesh of {given} refined to follow light to {error}{end}\nrefine {seconds:.2} s")
            },
        ));
        lines.extend(self.points.as_ref().map(PointReport::text));
        match self.invalid_vertices {
            0 => {}
            1 => lines.push("1 vertex lies inside geometry".to_owned()),
            n => lines.push(format!("{n} vertices lie inside geometry")),
        }
        let Seconds { load, build, solve, checkpoints, write, total } = self.seconds;
        lines.push(format!("load {load:.2} s"));
        lines.push(format!("build {build:.2} s"));
        lines.push(self.method.clone());
        lines.extend(self.steps.iter().map(StepReport::text));
        lines.push(format!("solve {solve:.2} s"));
        if checkpoints >= 0.005 {
            lines.push(format!("checkpoints {checkpoints:.2} s"));
        }
        lines.extend(self.lightmap.as_ref().map(LightmapReport::text));
        lines.push(format!("write {write:.2} s"));
        lines.push(format!("total {total:.2} s"));
        let threads = counted(self.threads, "thread", "threads");
        if self.rays > 0 {
            let rate = lumel::ray_rate(1e6 * self.mrays_per_second).map(|rate| format!(", {rate}"));
            lines.push(format!("rays {}{} on {threads}", self.rays, rate.unwrap_or_default()));
        }
        lines.extend(self.memory.text());
        lines.push(self.remainder_text());
        lines.extend(self.estimate.as_ref().map(EstimateReport::text));
        lines.extend(self.error.iter().flat_map(ErrorReport::text));
        for Written { path, bytes } in &self.files {
            lines.push(format!("wrote {}, {}", path.display(), report::bytes(*bytes)));
        }
        lines.join("\n") + "\n"
    }

    fn remainder_text(&self) -> String {
        let Some(remainder) = self.remainder else { return "remainder unknown".to_owned() };
        let fate = if self.tail { "estimated and added" } else { "not included" };
        format!("remainder {} of the light, in {}: {fate}", report::percent(remainder), self.remainder_in)
    }
}

/// All shots as one step, if light was shot.
fn shots_report(baker: &Baker, state: &SolveState, log: &SolveLog) -> Option<StepReport> {
    let shot = state.shot.as_ref()?;
    let is_shot = |step: &lumel::Step| matches!(step, lumel::Step::Shot(_));
    let seconds: Vec<f64> =
        log.steps.iter().filter(|(step, _)| is_shot(step)).map(|(_, seconds)| *seconds).collect();
    Some(StepReport {
        step: counted(shot.shots as usize, "shot", "shots"),
        seconds: (!seconds.is_empty()).then(|| seconds.iter().sum()),
        share: Some(1.0 - baker.shares(state).iter().sum::<f64>()),
        in_rounds: state.errors.is_some(),
    })
}

impl StepReport {
    fn text(&self) -> String {
        let of_light = self.share.map(|share| format!("{} of the light", report::percent(share)));
        let time = self.seconds.map(|seconds| format!("{seconds:.2} s"));
        match (self.in_rounds, time, of_light) {
            (true, _, Some(light)) => format!("{} {light}", self.step),
            (_, time, light) => {
                let time = time.unwrap_or_else(|| "from the checkpoint".to_owned());
                let light = light.map(|light| format!(", {light}")).unwrap_or_default();
                format!("{} {time}{light}", self.step)
            }
        }
    }
}
