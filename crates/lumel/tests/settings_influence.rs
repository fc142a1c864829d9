//! Settings have no more influence than their table says: what it says to stay the same has the same bits.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use lumel::setting::{self, Influence};
use lumel::{
    Baker, BounceLimit, Control, Directional, EmitterSampling, Layers, LightSampling, Memory, PointSpacing,
    Projection, SamplerKind, Scene, ScheduleKind, Settings, Silent, SolveState, SolverKind, Tail,
};
use std::sync::Arc;

fn usual() -> Settings {
    Settings {
        projection: Projection::Point,
        bounces: BounceLimit::Count(2),
        direct_samples: 4,
        indirect_samples: 8,
        ..Settings::default()
    }
}

/// Every setting other than usual. A new setting belongs here.
fn unusual() -> Settings {
    Settings {
        projection: Projection::Area,
        point_spacing: PointSpacing::Points(500),
        adaptive: "3%".parse().unwrap(),
        max_vertices: 1000,
        schedule: ScheduleKind::Shoot,
        bounces: BounceLimit::Count(3),
        remainder: 0.25,
        tail: Tail::Geometric,
        layers: Layers::Lights,
        directional: Directional::Sh1,
        direct_samples: 5,
        indirect_samples: 16,
        sampler: SamplerKind::Halton,
        light_sampling: LightSampling::Area,
        emitters: EmitterSampling::Rays,
        solver: SolverKind::Neumann,
        memory: Memory(1 << 30),
        target_error: "40%".parse().unwrap(),
        target_share: "80%".parse().unwrap(),
        seed: 9,
    }
}

/// The bounces of a solve, and the rays that it traced.
fn solved(baker: &Baker) -> (SolveState, u64) {
    let (mut state, control) = (SolveState::new(), Control::default());
    baker.run(&mut state, &control, &Silent).unwrap();
    (state, control.rays())
}

fn scene() -> Arc<Scene> {
    let opened = lumel::open("cornell-box", &lumel::OpenOptions::default()).unwrap();
    Arc::new(opened.builder.build().unwrap().0)
}

#[test]
fn a_setting_leaves_alone_what_it_is_said_not_to_influence() {
    let scene = scene();
    let baker = Baker::new(Arc::clone(&scene), usual());
    let (state, _) = solved(&baker);
    for setting in setting::ALL {
        let (name, influence) = (setting.about().name, setting.about().influence);
        let mut changed = usual();
        setting.copy(&unusual(), &mut changed);
        assert_eq!(changed.differing(&usual()).map(|s| s.about().name).collect::<Vec<_>>(), [name]);
        assert_eq!(changed.strongest_difference(&usual()), Some(influence));
        assert_eq!(baker.has_rays_of(&changed), influence > Influence::Rays, "{name}");
        if influence == Influence::Rays {
            continue;
        }
        let (new, all) = solved(&Baker::new(Arc::clone(&scene), changed.clone()));
        let (relit, rays) = solved(&baker.relit(Arc::clone(&scene), changed.clone()));
        assert!(rays < all, "{name}: hemisphere rays are traced again");
        assert!(relit.bounces == new.bounces, "{name}: stored rays are not those of a new solve");
        if influence > Influence::Bounces {
            assert!(changed.same_bounces_as(&usual()));
            let both = new.bounces.len().min(state.bounces.len());
            assert!(new.bounces[..both] == state.bounces[..both], "{name} changes bounces");
        }
    }
}
