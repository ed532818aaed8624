//! Shows a GLB with parallax maps: in a window, or as a picture.
//!
//! ```sh
//! cargo run --release --features window --example show -- deep.glb
//! cargo run --release --example show -- deep.glb --picture deep.png --from 1,0.5,2
//! cargo run --release --example show -- deep.glb --cost --size 2048
//! ```

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::{AssetPlugin, UnapprovedPathMode};
use bevy::camera::RenderTarget;
use bevy::camera::primitives::Aabb;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass, MotionVectorPrepass, NormalPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::diagnostic::DiagnosticsStore;
use bevy::light::CascadeShadowConfigBuilder;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::window::ExitCondition;
use parbake_bevy_parallax::{ParallaxMaterial, ParallaxPlugin};
use std::path::PathBuf;
use std::time::Duration;

const USAGE: &str =
    "usage: show FILE.glb [--picture OUT.png] [--size N] [--from X,Y,Z] [--box X,Y,Z,X,Y,Z] [--off] [--hard] [--msaa-off] [--headlight]
            [--prepass] [--deferred] [--cost]
  --from     where the camera stands, seen from the model's middle
  --box      two corners of the box that it looks at, for the same view of two models; by default the model's
  --off      without the maps, as viewers show the file that do not know them
  --hard     borders of cutouts are not smooth
  --msaa-off one sample a pixel
  --headlight camera and light as `parbake turntable` has them, without a floor
  --prepass  depth, normals and motion are drawn before
  --deferred lit from a G-buffer; implies --msaa-off
  --cost     says how long each render pass takes on the GPU, and draws no picture";

/// Field of view, in radians: that of `parbake turntable`.
const FOV: f32 = 0.761_013_2;
/// Illuminance under which white is shown as white by Bevy's default exposure: π · 1.2 · 2^9.7.
const WHITE: f32 = 3_136.0;

/// What the command line says.
#[derive(Resource, Clone)]
struct Options {
    file: PathBuf,
    picture: Option<PathBuf>,
    size: u32,
    from: Vec3,
    looked_at: Option<[Vec3; 2]>,
    is_off: bool,
    is_hard: bool,
    is_msaa_off: bool,
    is_headlight: bool,
    is_prepass: bool,
    is_deferred: bool,
    is_cost: bool,
}

/// So many numbers, with commas between them.
fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(str::parse).collect();
    numbers.ok()?.try_into().ok()
}

impl Options {
    fn read() -> Option<Self> {
        let mut options = Self {
            file: PathBuf::new(),
            picture: None,
            size: 512,
            from: Vec3::new(1.0, 0.6, 2.0),
            looked_at: None,
            is_off: false,
            is_hard: false,
            is_msaa_off: false,
            is_headlight: false,
            is_prepass: false,
            is_deferred: false,
            is_cost: false,
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--picture" => options.picture = Some(arguments.next()?.into()),
                "--size" => options.size = arguments.next()?.parse().ok()?,
                "--from" => options.from = Vec3::from_array(numbers(&arguments.next()?)?),
                "--box" => {
                    let [a, b, c, d, e, f] = numbers(&arguments.next()?)?;
                    options.looked_at = Some([Vec3::new(a, b, c), Vec3::new(d, e, f)]);
                }
                "--off" => options.is_off = true,
                "--hard" => options.is_hard = true,
                "--msaa-off" => options.is_msaa_off = true,
                "--headlight" => options.is_headlight = true,
                "--prepass" => options.is_prepass = true,
                "--cost" => options.is_cost = true,
                "--deferred" => (options.is_deferred, options.is_msaa_off) = (true, true),
                file if options.file.as_os_str().is_empty() && !file.starts_with('-') => {
                    options.file = file.into()
                }
                _ => return None,
            }
        }
        (!options.file.as_os_str().is_empty()).then_some(options)
    }
}

/// What is shown, and what it is shown on.
#[derive(Resource)]
struct Shown {
    model: Handle<WorldAsset>,
    target: Option<Handle<Image>>,
    /// Frames since all was there.
    frames: u32,
    /// Where the model stands, and half of its longest side.
    bottom: Vec3,
    radius: f32,
}

fn main() -> AppExit {
    let Some(options) = Options::read() else {
        eprintln!("{USAGE}");
        return AppExit::error();
    };
    let is_picture = options.picture.is_some() || options.is_cost || cfg!(not(feature = "window"));
    let window = (!is_picture).then(|| Window { title: "Parallax maps".into(), ..default() });
    let exit_condition = if is_picture { ExitCondition::DontExit } else { ExitCondition::OnAllClosed };
    let plugins = DefaultPlugins
        .set(WindowPlugin { primary_window: window, exit_condition, ..default() })
        // Files of any folder.
        .set(AssetPlugin {
            file_path: "/".into(),
            unapproved_path_mode: UnapprovedPathMode::Allow,
            ..default()
        })
        .set(RenderPlugin { synchronous_pipeline_compilation: is_picture, ..default() });
    let mut app = App::new();
    #[cfg(feature = "window")]
    let plugins = if is_picture { plugins.disable::<bevy::winit::WinitPlugin>() } else { plugins };
    app.add_plugins(plugins);
    if is_picture {
        app.add_plugins(ScheduleRunnerPlugin::run_loop(Duration::ZERO));
    }
    if !options.is_off {
        app.add_plugins(ParallaxPlugin { smooth_borders: !options.is_hard });
    }
    if options.is_cost {
        app.add_plugins(RenderDiagnosticsPlugin).add_systems(Update, measure.after(frame_all));
    }
    if options.is_deferred {
        app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    }
    app.insert_resource(options);
    app.add_systems(Startup, begin).add_systems(Update, (frame_all, light_all, take_picture).chain());
    app.run()
}

fn begin(
    mut commands: Commands,
    options: Res<Options>,
    server: Res<AssetServer>,
    mut images: ResMut<Assets<Image>>,
) {
    let file = std::path::absolute(&options.file).unwrap_or_else(|_| options.file.clone());
    let model = server.load(GltfAssetLabel::Scene(0).from_asset(file));
    commands.spawn(WorldAssetRoot(model.clone()));
    let target = (options.picture.is_some() || options.is_cost).then(|| {
        let size = options.size;
        images.add(Image::new_target_texture(size, size, TextureFormat::Rgba8UnormSrgb, None))
    });
    let mut camera = commands.spawn((
        Camera3d::default(),
        Camera { clear_color: ClearColorConfig::Custom(Color::linear_rgb(0.2, 0.2, 0.2)), ..default() },
        Tonemapping::None,
        if options.is_msaa_off { Msaa::Off } else { Msaa::Sample4 },
        AmbientLight { brightness: if options.is_headlight { 0.0 } else { 250.0 }, ..default() },
        Projection::Perspective(PerspectiveProjection { fov: FOV, ..default() }),
    ));
    if options.is_prepass {
        camera.insert((DepthPrepass, NormalPrepass, MotionVectorPrepass));
    }
    if options.is_deferred {
        camera.insert((DepthPrepass, DeferredPrepass));
    }
    if let Some(image) = &target {
        camera.insert(RenderTarget::Image(image.clone().into()));
    }
    commands.insert_resource(Shown { model, target, frames: 0, bottom: Vec3::ZERO, radius: 1.0 });
}

/// Once the model is there: the camera, and the box that it looks at.
fn frame_all(
    options: Res<Options>,
    mut shown: ResMut<Shown>,
    server: Res<AssetServer>,
    boxes: Query<(&GlobalTransform, &Aabb), With<Mesh3d>>,
    mut camera: Query<&mut Transform, With<Camera3d>>,
) {
    if shown.frames > 0 || !server.is_loaded_with_dependencies(&shown.model) || boxes.is_empty() {
        shown.frames += u32::from(shown.frames > 0);
        return;
    }
    shown.frames = 1;
    let corners = boxes.iter().flat_map(|(placed, aabb)| {
        [aabb.min(), aabb.max()].map(|corner| placed.transform_point(corner.into()))
    });
    let [low, high] = corners.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], corner| {
        [low.min(corner), high.max(corner)]
    });
    shown.bottom = Vec3::new((low.x + high.x) / 2.0, low.y, (low.z + high.z) / 2.0);
    let [low, high] = options.looked_at.unwrap_or([low, high]);
    let (middle, radius) = ((low + high) / 2.0, (high - low).max_element() / 2.0);
    let eye = Transform::from_translation(middle + options.from.normalize() * radius * 3.5);
    for mut transform in &mut camera {
        *transform = eye.looking_at(middle, Vec3::Y);
    }
    shown.radius = radius;
}

/// A light with shadows, and a floor for them; or one where the camera is.
fn light_all(
    mut commands: Commands,
    options: Res<Options>,
    shown: Res<Shown>,
    camera: Query<&Transform, With<Camera3d>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if shown.frames != 1 {
        return;
    }
    if options.is_headlight {
        for eye in &camera {
            commands.spawn((DirectionalLight { illuminance: WHITE, ..default() }, *eye));
        }
        return;
    }
    commands.spawn((
        DirectionalLight { illuminance: 1.2 * WHITE, shadow_maps_enabled: true, ..default() },
        CascadeShadowConfigBuilder { maximum_distance: 8.0 * shown.radius, ..default() }.build(),
        Transform::from_xyz(1.5, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    let grey = Color::srgb(0.6, 0.6, 0.6);
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::new(Vec3::Y, Vec2::splat(4.0 * shown.radius)))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: grey,
            perceptual_roughness: 1.0,
            ..default()
        })),
        Transform::from_translation(shown.bottom),
    ));
}

/// After some frames, for the renderer to have everything.
fn take_picture(
    mut commands: Commands,
    options: Res<Options>,
    shown: Res<Shown>,
    maps: Option<Res<Assets<ParallaxMaterial>>>,
) {
    let (Some(target), Some(path), 10) = (&shown.target, &options.picture, shown.frames) else { return };
    info!("materials with parallax maps: {}", maps.map_or(0, |maps| maps.len()));
    commands.spawn(Screenshot::image(target.clone())).observe(save_to_disk(path.clone())).observe(
        |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
            exit.write(AppExit::Success);
        },
    );
}

/// Frames before any are measured: pipelines are compiled and clocks rise.
const WARM_UP: u32 = 300;
/// Frames that are measured: as many as Bevy remembers.
const MEASURED: u32 = 120;

/// How long each pass of the last frames took, by the GPU's own clock.
fn measure(shown: Res<Shown>, diagnostics: Res<DiagnosticsStore>, mut exit: MessageWriter<AppExit>) {
    if shown.frames != WARM_UP + MEASURED {
        return;
    }
    for one in diagnostics.iter() {
        let path = one.path().as_str();
        let Some(pass) = path.strip_prefix("render/").and_then(|path| path.strip_suffix("/elapsed_gpu"))
        else {
            continue;
        };
        let mut values: Vec<f64> = one.values().copied().collect();
        values.sort_by(f64::total_cmp);
        if let Some(median) = values.get(values.len() / 2) {
            println!("{pass}: {median:.4} ms (median of {} frames)", values.len());
        }
    }
    exit.write(AppExit::Success);
}
