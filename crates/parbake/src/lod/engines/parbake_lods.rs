//! Levels of detail of a `lods.json` that Parbake has written, for Bevy 0.16.
//!
//! Needs the crates `serde` and `serde_json`. Spawn an entity with [`Lods`] and a `Transform`:
//!
//! ```ignore
//! app.add_plugins(ParbakeLodsPlugin);
//! commands.spawn((Lods::read("assets/@NAME@/lods.json", "@NAME@")?, Transform::default(), Visibility::default()));
//! ```

use bevy::prelude::*;
use bevy::render::view::VisibilityRange;
use serde::Deserialize;

/// Gives each level its range of distances.
pub struct ParbakeLodsPlugin;

impl Plugin for ParbakeLodsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, (spawn_levels, set_ranges));
    }
}

/// A chain of levels; they become children.
#[derive(Component, Deserialize)]
pub struct Lods {
    longest_side: f32,
    levels: Vec<Level>,
    /// The files' folder within the assets.
    #[serde(skip)]
    folder: String,
    /// Vertical field of view of the cameras, in radians.
    #[serde(skip)]
    pub field_of_view: f32,
}

#[derive(Deserialize)]
struct Level {
    file: String,
    min_coverage: f32,
}

/// The range of a level, until its meshes are there.
#[derive(Component)]
struct Pending(VisibilityRange);

impl Lods {
    /// Reads a `lods.json`; `folder` is where the files lie within the assets.
    pub fn read(path: &str, folder: &str) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let mut lods: Self = serde_json::from_str(&std::fs::read_to_string(path)?)?;
        (lods.folder, lods.field_of_view) = (folder.into(), std::f32::consts::FRAC_PI_4);
        Ok(lods)
    }

    /// The distance at which a level ends.
    fn end(&self, level: &Level) -> f32 {
        if level.min_coverage <= 0.0 { return f32::MAX };
        self.longest_side / (2.0 * level.min_coverage * (0.5 * self.field_of_view).tan())
    }
}

fn spawn_levels(mut commands: Commands, assets: Res<AssetServer>, new: Query<(Entity, &Lods), Added<Lods>>) {
    for (entity, lods) in &new {
        let mut begin = 0.0..0.0;
        for level in &lods.levels {
            let end = lods.end(level);
            // The end of one level is the beginning of the next, fading included.
            let end = if end == f32::MAX { end..end } else { 0.95 * end..1.05 * end };
            let range = VisibilityRange { start_margin: begin, end_margin: end.clone(), use_aabb: false };
            let scene = assets.load(GltfAssetLabel::Scene(0).from_asset(format!("{}/{}", lods.folder, level.file)));
            commands.spawn((SceneRoot(scene), Pending(range), ChildOf(entity)));
            begin = end;
        }
    }
}

fn set_ranges(
    mut commands: Commands,
    levels: Query<(Entity, &Pending)>,
    children: Query<&Children>,
    meshes: Query<(), With<Mesh3d>>,
) {
    for (level, Pending(range)) in &levels {
        let own: Vec<Entity> = children.iter_descendants(level).filter(|e| meshes.contains(*e)).collect();
        if !own.is_empty() {
            own.into_iter().for_each(|mesh| { commands.entity(mesh).insert(range.clone()); });
            commands.entity(level).remove::<Pending>();
        }
    }
}
