//! `parbake eval`.

use crate::arguments::EvalCommand;
use crate::bake::read_pair;
use crate::document::write_document;
use crate::failure::{Ending, Failure};
use crate::outputs::{check_beside, is_stdout};
use crate::printed::print;
use crate::progress::Console;
use crate::rules;
use clap::ArgMatches;
use parbake::{ViewFigures, evaluate, with_threads, write_file};
use parbake_report::evaluation_report;

/// Runs the command.
pub fn run(command: &EvalCommand, given: &ArgMatches) -> Result<Ending, Failure> {
    rules::check_eval(&command.evaluate, given)?;
    command.evaluate.check()?;
    check_beside(None, command.json.as_ref(), command.report.as_ref(), &[&command.high, &command.low])?;
    let console = Console::new(command.talk).confined(command.reading).with_stage_times();
    with_threads(command.threads, || {
        let pair = read_pair(&command.high, &command.low, &console)?;
        let evaluation = evaluate(&pair.high, &pair.low, &command.evaluate, &console)?;
        console.finish();
        let to_stdout = command.json.as_ref().is_some_and(|path| is_stdout(path));
        if let Some(path) = &command.json {
            let files = [("high", command.high.as_path()), ("low", command.low.as_path())];
            write_document(path, ("eval", &files, None), &evaluation, &console)?;
        }
        if !to_stdout {
            let mut table = String::from("view    PSNR dB   MS-SSIM   FLIP");
            let shown = if command.per_view { &evaluation.views[..] } else { &[] };
            for (index, view) in shown.iter().enumerate() {
                table += &format!("\n{:4}  {}", index + 1, figures(view));
            }
            table += &format!("\nmean  {}", figures(&evaluation.mean));
            if !evaluation.channels.is_empty() {
                table += "\n\nchannel        PSNR dB   MS-SSIM   FLIP";
            }
            for of in &evaluation.channels {
                table += &format!("\n{:13}{}", of.channel.label(), figures(&of.mean));
            }
            print(&table)?;
        }
        if let Some(path) = &command.report {
            let page = evaluation_report(&pair.high, &pair.low, &evaluation, &console)?;
            write_file(path, page.as_bytes())?;
            console.finish();
        }
        Ok(Ending::Finished)
    })?
}

fn figures(f: &ViewFigures) -> String {
    let optional = |x: Option<f64>| x.map_or("-".to_string(), |x| format!("{x:.4}"));
    format!("{:9.3}   {:>7}   {:>6}", f.psnr, optional(f.ms_ssim), optional(f.flip))
}
