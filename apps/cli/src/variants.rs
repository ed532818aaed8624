//! `parbake variants`.

use crate::arguments::VariantsCommand;
use crate::bake::read_pair;
use crate::failure::{Ending, Failure};
use crate::outputs::{check_beside, is_stdout};
use crate::printed::{print, write_json};
use crate::progress::Console;
use parbake::{with_threads, write_file};
use parbake_reproduce::variants::{VariantsReport, compare_variants, variants_html};

/// Runs the command.
pub fn run(command: &VariantsCommand) -> Result<Ending, Failure> {
    let options = &command.variants;
    options.check()?;
    let json = command.json.as_deref();
    let to_stdout = json.is_some_and(is_stdout);
    let inputs = [command.high.as_path(), command.low.as_path()];
    check_beside(None, command.json.as_ref(), Some(&command.output), &inputs)?;
    // Stopped, it shows the variants that it has.
    let console = Console::for_bake(command.talk, None).confined(command.reading).with_stage_times();
    with_threads(options.threads, || {
        let pair = read_pair(&command.high, &command.low, &console)?;
        let compared = compare_variants(&pair.high, &pair.low, options, &console)?;
        write_file(&command.output, variants_html(&pair.high, &compared)?.as_bytes())?;
        if let Some(path) = json {
            write_json(path, &compared.report)?;
        }
        console.finish();
        if !to_stdout && !command.talk.quiet {
            print(&table(&compared.report))?;
        }
        console.say(&format!("look at {}, {:.1} s", command.output.display(), console.seconds()));
        Ok(if compared.report.stopped_early { Ending::Interrupted } else { Ending::Finished })
    })?
}

fn table(report: &VariantsReport) -> String {
    let mut text =
        String::from("variant              PSNR dB   MS-SSIM   places   fetches     bytes   seconds");
    for v in &report.variants {
        let ms_ssim = v.ms_ssim.map_or("-".to_string(), |x| format!("{x:.4}"));
        text += &format!(
            "\n{:20} {:7.3}   {ms_ssim:>7}   {:6}   {:7}   {:7}   {:7.1}",
            v.name, v.psnr, v.places, v.fetches, v.bytes, v.seconds
        );
    }
    text
}
