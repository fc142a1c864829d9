use crate::{Stage, noise, stages};
use glam::Vec3;
use lumel_lightmap::Dilation;
use std::collections::BTreeSet;

/// The chart of each lumel that is read.
fn charts(stage: &Stage) -> Vec<(usize, usize)> {
    let chart = |place: usize| stage.atlas.chart(stage.coverage.shares(place)[0].tri);
    stage.coverage.lumels().iter().enumerate().map(|(place, &lumel)| (lumel as usize, chart(place))).collect()
}

/// Each lumel's own number where it is valid.
fn numbers(valid: &[bool]) -> Vec<Vec3> {
    (0..valid.len()).map(|lumel| if valid[lumel] { Vec3::splat(lumel as f32) } else { Vec3::NAN }).collect()
}

/// Squared; `None` between pages.
fn distance(stage: &Stage, a: usize, b: usize) -> Option<u32> {
    let [(page, [xa, ya]), (other, [xb, yb])] = [a, b].map(|lumel| stage.atlas.column_and_row(lumel));
    (page == other).then_some(xa.abs_diff(xb).pow(2) + ya.abs_diff(yb).pow(2))
}

#[test]
fn hidden_lumels_have_the_light_of_the_nearest_valid_one_of_their_chart() {
    for (name, stage) in stages() {
        let charts = charts(&stage);
        let mut valid = vec![false; stage.atlas.lumel_count()];
        // One in nine, so that the nearest valid lumel is often of another chart.
        charts.iter().for_each(|&(lumel, _)| valid[lumel] = noise(lumel) < 1.0 / 9.0);
        let dilation = Dilation::new(&stage.atlas, &stage.coverage, &valid);
        let mut values = numbers(&valid);
        dilation.fill(&mut values);
        let with_light: BTreeSet<usize> =
            charts.iter().filter(|(lumel, _)| valid[*lumel]).map(|(_, chart)| *chart).collect();
        for &(lumel, chart) in charts.iter().filter(|(_, chart)| with_light.contains(chart)) {
            let source = values[lumel].x as usize;
            let sources = charts.iter().filter(|(other, of)| *of == chart && valid[*other]);
            let nearest = sources.filter_map(|(other, _)| distance(&stage, lumel, *other)).min();
            assert_eq!(distance(&stage, lumel, source), nearest, "{name}");
            assert!(charts.contains(&(source, chart)), "{name}");
            assert!(!valid[lumel] || source == lumel, "{name}: valid ones keep their light");
        }
    }
}

#[test]
fn all_of_a_page_has_light() {
    for (name, stage) in stages() {
        let charts = charts(&stage);
        let mut valid = vec![false; stage.atlas.lumel_count()];
        charts.iter().for_each(|&(lumel, _)| valid[lumel] = true);
        let mut values = numbers(&valid);
        Dilation::new(&stage.atlas, &stage.coverage, &valid).fill(&mut values);
        for (lumel, value) in values.iter().enumerate().filter(|(lumel, _)| lumel % 5 == 0 && !valid[*lumel])
        {
            let nearest = charts.iter().filter_map(|(other, _)| distance(&stage, lumel, *other)).min();
            assert_eq!(distance(&stage, lumel, value.x as usize), nearest, "{name}");
        }
    }
}

#[test]
fn a_chart_without_light_takes_what_is_near_and_a_page_without_any_is_black() {
    let (_, stage) = stages().remove(0);
    let charts = charts(&stage);
    let mut valid = vec![false; stage.atlas.lumel_count()];
    charts.iter().for_each(|&(lumel, chart)| valid[lumel] = chart == 1);
    let mut values = numbers(&valid);
    Dilation::new(&stage.atlas, &stage.coverage, &valid).fill(&mut values);
    assert!(values.iter().all(|value| charts.contains(&(value.x as usize, 1))));
    valid.fill(false);
    Dilation::new(&stage.atlas, &stage.coverage, &valid).fill(&mut values);
    assert!(values.iter().all(|value| *value == Vec3::ZERO));
}
