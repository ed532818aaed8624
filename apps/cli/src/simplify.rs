//! `parbake simplify`.

use crate::arguments::{ClosestIn, SimplifyCommand};
use crate::bake::read_with_pictures;
use crate::failure::{Ending, Failure};
use crate::formats::{check_formats, write_model_keeping};
use crate::outputs::{check_not_input, check_output};
use crate::progress::Console;
use crate::rules;
use clap::ArgMatches;
use parbake::{Loaded, PictureFiles, simplified, simplified_by_pictures, subdivided};

/// Runs the command.
pub fn run(command: &SimplifyCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    rules::check_quality(&command.formats, given)?;
    check_output(&command.output)?;
    check_formats(&command.output, &command.formats)?;
    check_not_input(&command.output, &[&command.model])?;
    if command.triangles < 4 {
        return Err(Failure::Usage(format!("--triangles {}: at least 4", command.triangles)));
    }
    let console = Console::new(command.talk).confined(command.reading);
    let Loaded { model, mut pictures, .. } = read_with_pictures(&command.model, &console)?;
    // By default textures need not be PNG; who types it wants to convert them.
    if rules::is_typed(given, "texture_format") {
        pictures = PictureFiles::default();
    }
    let result = match command.subdivide {
        Some(times) => (0..times).fold(model.clone(), |m, _| subdivided(&m)),
        None => match command.closest_in {
            ClosestIn::Pictures => simplified_by_pictures(&model, command.triangles, &console),
            ClosestIn::Shape => simplified(&model, command.triangles),
        },
    };
    write_model_keeping(&command.output, &result, &command.formats, &pictures, &console)?;
    console.finish();
    console.say(&format!(
        "{}: {} triangles from {}",
        command.output.display(),
        result.mesh.triangles.len(),
        model.mesh.triangles.len()
    ));
    console.detail(&format!("read, simplified and written in {:.2} s", console.seconds()));
    Ok(Ending::Finished)
}
