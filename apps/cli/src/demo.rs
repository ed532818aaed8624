//! `parbake demo`: everything from nothing.

use crate::arguments::{DemoCommand, DemoScene};
use crate::bake::{Pair, bake_and_write, compare, ending, tell, write_report};
use crate::document::write_report_document;
use crate::failure::{Ending, Failure};
use crate::outputs::{check_folder, check_place, make_folder};
use crate::pictures::write_pictures;
use crate::progress::Console;
use crate::rules;
use clap::ArgMatches;
use parbake::{Detail, check_budget, demo_pair, wall_pair, with_threads, write_glb};

/// File of the pictures.
const PICTURE: &str = "demo.webp";

/// Runs the command.
pub fn run(command: &DemoCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    rules::check_demo(&command.bake, given)?;
    command.bake.check()?;
    check_budget(&command.bake)?;
    let folder = &command.output;
    check_folder(folder)?;
    make_folder(folder)?;
    check_place(&folder.join("demo.glb"))?;
    if let Some(pictures) = &command.pictures {
        make_folder(pictures)?;
        check_place(&pictures.join(PICTURE))?;
    }
    let console = Console::for_bake(command.talk, command.bake.time_budget);
    with_threads(command.bake.threads, || {
        let (high, low) = match command.scene {
            DemoScene::Jar => demo_pair(),
            DemoScene::Wall => wall_pair(),
        };
        write_glb(&folder.join("demo_high.glb"), &high)?;
        write_glb(&folder.join("demo_low.glb"), &low)?;
        let output = folder.join("demo.glb");
        let pair = Pair { high, low, warnings: Vec::new(), seconds: None };
        let mut baked = bake_and_write(&pair, &command.bake, &output, &console)?;
        compare(&pair.high, &mut baked, Detail::ALL, &console)?;
        let report = folder.join("demo.html");
        write_report(&report, &pair.high, &baked, &console)?;
        let [high, low] = ["demo_high.glb", "demo_low.glb"].map(|name| folder.join(name));
        let files = [("high", high.as_path()), ("low", low.as_path())];
        let about = ("demo", &files[..], Some(output.as_path()));
        write_report_document(&folder.join("demo.json"), about, &baked.report, &console)?;
        if let Some(folder) = &command.pictures {
            write_pictures(&folder.join(PICTURE), &pair, &baked, &console)?;
        }
        console.finish();
        tell(&console, command.talk, &baked.report, &output);
        console.say(&format!("look at {}", report.display()));
        Ok(ending(&baked.report))
    })?
}
