//! Compares two models picture by picture: PSNR, MS-SSIM and FLIP (`figures.rs`) over views spread
//! around them; where whole materials are compared, of what is seen and of each channel (`channels.rs`).

use crate::channels::{Channel, ChannelFigures};
use crate::conventions::Shading;
use crate::error::EvaluateError;
use crate::figures::{Metrics, ViewFigures, compare, mean};
use crate::options::EvaluateOptions;
use crate::renderer::{PlacedModel, RenderedView, Renderer};
use parbake_model::Model;
use parbake_progress::{Message, Stage, Watcher};
use parbake_views::lost::not_compared;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Figures of a pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The conventions.
    pub options: EvaluateOptions,
    /// How both were shaded: [`Shading::Lambert`] or [`Shading::Pbr`].
    pub shading: Shading,
    /// Averages over the views.
    pub mean: ViewFigures,
    /// Each view's figures.
    pub views: Vec<ViewFigures>,
    /// The material's channels; none under [`Shading::Lambert`]. They do not depend on the background.
    pub channels: Vec<ChannelFigures>,
}

/// Compares `low` with `high`.
///
/// # Errors
/// An option out of range; a high-poly without extent.
pub fn evaluate(
    high: &Model,
    low: &Model,
    options: &EvaluateOptions,
    watcher: &dyn Watcher,
) -> Result<Evaluation, EvaluateError> {
    let mut all = evaluate_on(high, low, options, &[&options.background], watcher)?;
    Ok(all.remove(0))
}

/// Compares them before several backgrounds in turn, each as `options.background` has it; a view
/// is rendered once for all of them.
///
/// # Errors
/// As of [`evaluate`].
pub fn evaluate_on(
    high: &Model,
    low: &Model,
    options: &EvaluateOptions,
    backgrounds: &[&str],
    watcher: &dyn Watcher,
) -> Result<Vec<Evaluation>, EvaluateError> {
    let unjudged = not_compared(high.materials.iter().chain(&low.materials));
    unjudged.into_iter().for_each(|text| watcher.message(Message::Warning(text)));
    let detail = Detail { metrics: Metrics { flip: !options.no_flip, ..Metrics::ALL }, channels: true };
    let Compared { shading, channels, views } =
        evaluate_each(high, &[low], options, backgrounds, detail, watcher)?;
    let of_channel = |(k, &channel): (usize, &Channel)| {
        let views: Vec<ViewFigures> = views.iter().map(|view| view.channels[0][k]).collect();
        ChannelFigures { channel, mean: mean(&views), views }
    };
    let channels: Vec<ChannelFigures> = channels.iter().enumerate().map(of_channel).collect();
    let of = |(k, &name): (usize, &&str)| {
        let views: Vec<ViewFigures> = views.iter().map(|view| view.seen[0][k]).collect();
        let options = EvaluateOptions { background: name.into(), ..options.clone() };
        Evaluation { options, shading, mean: mean(&views), views, channels: channels.clone() }
    };
    Ok(backgrounds.iter().enumerate().map(of).collect())
}

/// What is compared besides the PSNR of what is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detail {
    /// Other figures.
    pub metrics: Metrics,
    /// The channels of whole materials.
    pub channels: bool,
}

impl Detail {
    /// All of it.
    pub const ALL: Self = Self { metrics: Metrics::ALL, channels: true };
}

/// What became of a comparison.
pub struct Compared {
    /// How all were shaded.
    pub shading: Shading,
    /// The channels that were compared.
    pub channels: Vec<Channel>,
    /// Each view.
    pub views: Vec<ComparedView>,
}

/// One view.
pub struct ComparedView {
    /// The figures of each model on each background.
    pub seen: Vec<Vec<ViewFigures>>,
    /// Those of each model's channels.
    pub channels: Vec<Vec<ViewFigures>>,
}

/// Compares several models with one high-poly, which is rendered once for all of them, on each background, and
/// channel by channel if `detail` says so and if whole materials are compared. `detail` decides on FLIP, not
/// [`EvaluateOptions::no_flip`].
///
/// # Errors
/// As of [`evaluate`].
pub fn evaluate_each(
    high: &Model,
    low: &[&Model],
    options: &EvaluateOptions,
    backgrounds: &[&str],
    detail: Detail,
    watcher: &dyn Watcher,
) -> Result<Compared, EvaluateError> {
    let color =
        |&name: &&str| EvaluateOptions { background: name.into(), ..options.clone() }.checked_background();
    let colors: Vec<[f32; 3]> = backgrounds.iter().map(color).collect::<Result<_, _>>()?;
    let renderer = Renderer::new(high, options)?;
    let shading = renderer.shading();
    let high = renderer.place(high);
    let low: Vec<PlacedModel> = low.iter().map(|low| renderer.place(low)).collect();
    let channels = match detail.channels && shading == Shading::Pbr {
        true => Channel::of(std::iter::once(&high).chain(&low)),
        false => Vec::new(),
    };
    let done = AtomicUsize::new(0);
    let views = options.directions().into_par_iter().map(|direction| {
        let render = |model: &PlacedModel| match channels.is_empty() {
            true => renderer.render(model, direction),
            false => renderer.render_with_channels(model, direction),
        };
        let wanted = render(&high);
        let pictures = renderer.tonemap_on(&wanted, &colors);
        let mut view = ComparedView { seen: Vec::new(), channels: Vec::new() };
        for low in &low {
            let own: RenderedView = render(low);
            let shown = renderer.tonemap_on(&own, &colors);
            let pairs = pictures.iter().zip(&shown);
            view.seen.push(pairs.map(|(wanted, own)| compare(wanted, own, detail.metrics)).collect());
            let of = |channel: &Channel| channel.compare(&wanted, &own, detail.metrics);
            view.channels.push(channels.iter().map(of).collect());
        }
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        watcher.message(Message::Progress { stage: Stage::Evaluate, done, total: options.views });
        view
    });
    Ok(Compared { shading, views: views.collect(), channels })
}
