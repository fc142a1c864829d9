//! Solves with each projection.

use crate::place::Place;
use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{Baker, Control, Projection, Settings, Silent, SolveState};
use lumel_basis::{Basis, Field, PointReceivers};
use lumel_transport::{Job, Source, accumulate};
use std::sync::Arc;
use std::time::Instant;

/// How light is measured, carried from bounce to bounce and read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// As a projection of the settings does.
    Projection(Projection),
    /// Carried over areas, and read by one more gather at the vertices. Only measured here.
    Gathered,
}

impl Way {
    pub(crate) const ALL: [Self; 4] = [
        Self::Projection(Projection::Point),
        Self::Projection(Projection::Area),
        Self::Projection(Projection::LeastSquares),
        Self::Gathered,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Projection(Projection::Point) => "point",
            Self::Projection(Projection::Area) => "area",
            Self::Projection(Projection::LeastSquares) => "least-squares",
            Self::Gathered => "area, gathered",
        }
    }

    /// Solves, and reads all light at the vertices.
    pub(crate) fn solve(self, place: &Place, settings: &Settings) -> Solved {
        let projection = if let Self::Projection(projection) = self { projection } else { Projection::Area };
        let settings = Settings { projection, ..settings.clone() };
        let (start, cpu) = (Instant::now(), ProcessTime::now());
        let baker = Baker::with_tracer(Arc::clone(&place.scene), Arc::clone(&place.tracer), settings);
        let mut state = SolveState::new();
        let control = Control::default();
        baker.run(&mut state, &control, &Silent).unwrap();
        let (direct, all) = match self {
            Self::Projection(_) => (None, baker.light_at_vertices(&state)),
            Self::Gathered => {
                let [direct, reflected] = gathered(place, &baker, &state, &control);
                let all = Field::sum(direct.node_count(), [&direct, &reflected]);
                (Some(direct), baker.carried_at_vertices(&all))
            }
        };
        let (seconds, cpu_seconds) = (start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
        let direct = match &direct {
            None => baker.light_reader(&state).at_vertices(&state.bounces[0]),
            Some(direct) => baker.carried_at_vertices(direct),
        };
        Solved { seconds, cpu_seconds, rays: control.rays(), carried: state.bounces, direct, all }
    }
}

/// Light as a solve left it.
pub(crate) struct Solved {
    pub(crate) seconds: f64,
    /// Processor time of all threads.
    pub(crate) cpu_seconds: f64,
    /// Hemisphere and shadow rays.
    pub(crate) rays: u64,
    /// Bounces as they are carried.
    pub(crate) carried: Vec<Field>,
    /// Direct light as it is read at the vertices of the scene, W·m⁻².
    pub(crate) direct: Vec<Vec3>,
    /// All light as it is read there.
    pub(crate) all: Vec<Vec3>,
}

/// Direct light, and what the surfaces reflect of all bounces but the last, measured at the nodes.
fn gathered(place: &Place, baker: &Baker, state: &SolveState, control: &Control) -> [Field; 2] {
    let transport = place.towards(PointReceivers::at_vertices(&place.basis), baker.settings().plan());
    let measure = |source, bounce, active| {
        let job = Job { source, bounce, pass: 0, active };
        accumulate(&transport, &job, control, None).unwrap()
    };
    let visible: Vec<bool> = measure(Source::Nothing, 0, None).visible().collect();
    let measured = |source, bounce| {
        let mut measured = measure(source, bounce, Some(&visible));
        place.basis.adjacency().complete(&mut measured.field, &measured.known);
        measured.field
    };
    let (_, reflecting) = state.bounces.split_last().unwrap();
    let reflecting = Field::sum(place.basis.node_count(), reflecting);
    [measured(Source::Emitters(None), 0), measured(Source::Field(&reflecting), 1)]
}
