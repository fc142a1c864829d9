use crate::Outcome;
pub(crate) fn run(
    _: &crate::args::MeasureArgs,
    _: &std::sync::Arc<crate::console::Console>,
) -> anyhow::Result<Outcome> {
    Ok(Outcome::Done)
}
