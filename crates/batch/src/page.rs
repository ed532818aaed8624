//! One page of a batch, and the same as JSON: for each job its picture, the figures of its JSON, seconds, bytes and
//! memory; failures first, with their sentences.
//!
//! Contract: all text is escaped; figures that a command does not have are left out. The page needs no other file.

use crate::job::FIGURES;
use crate::outcome::{Batch, Ended, Outcome};
use crate::place::Place;
use crate::record::Record;
use parbake_report::page::text::{count, decimal, duration, escape};
use parbake_report::page::{base64, document, section};
use serde_json::{Value, json};
use std::path::Path;

/// The picture's name in a job's folder.
pub const PICTURE: &str = "picture.png";

/// Pictures of more bytes are none that this program has taken.
const LARGEST_PICTURE: u64 = 2_000_000;

/// Heads of the table's columns.
const HEAD: [&str; 9] =
    ["job", "command", "before", "after", "gain", "triangles", "bytes", "seconds", "memory"];

/// The page.
pub fn html(batch: &Batch, place: &Place) -> String {
    let mut out = format!(
        r#"<header><p class="kicker">{} of {} jobs finished</p><h1>{}</h1></header>"#,
        count(batch.jobs.iter().filter(|ended| ended.outcome.record().is_some()).count()),
        count(batch.jobs.len()),
        escape(&place.output().file_name().unwrap_or_default().to_string_lossy())
    );
    let mut notes = String::new();
    for (name, reason) in failures(batch) {
        notes += &format!("<li><b>{}</b> failed: {}</li>", escape(name), escape(reason));
    }
    if batch.stopped {
        notes += "<li>The batch was stopped; run the same command again to go on.</li>";
    }
    if !notes.is_empty() {
        out += &format!(r#"<ul class="notes">{notes}</ul>"#);
    }
    let finished: Vec<(&Ended, &Record, Value)> = (batch.jobs.iter())
        .filter_map(|ended| {
            let record = ended.outcome.record()?;
            let figures = std::fs::read(place.of(&record.name).join(FIGURES)).unwrap_or_default();
            Some((ended, record, serde_json::from_slice(&figures).unwrap_or_default()))
        })
        .collect();
    if !finished.is_empty() {
        let plates: String =
            finished.iter().map(|(_, record, figures)| plate(record, figures, place)).collect();
        section(&mut out, "results", "Results", "", &format!(r#"<div class="plates">{plates}</div>"#));
        let rows: Vec<[String; HEAD.len()]> =
            finished.iter().map(|(ended, record, figures)| row(ended, record, figures)).collect();
        // Columns of figures that no command here has are left out.
        let shown = |column: usize| rows.iter().any(|row| !row[column].is_empty());
        let line = |cells: &[String; HEAD.len()], element: &str| -> String {
            let cells = cells.iter().enumerate().filter(|(column, _)| shown(*column));
            let cell = |(column, text): (usize, &String)| {
                let element = if column == 0 { "th" } else { element };
                format!("<{element}>{text}</{element}>")
            };
            format!("<tr>{}</tr>", cells.map(cell).collect::<String>())
        };
        let head = line(&HEAD.map(String::from), "th");
        let rows: String = rows.iter().map(|row| line(row, "td")).collect();
        let table = format!(
            r#"<div class="wide"><table class="numbers-table"><thead>{head}</thead><tbody>{rows}</tbody></table></div>"#
        );
        let lead = "Before and after are PSNR in dB on black: a ray-cast bake or the coordinates as they were, and the \
                    result. Seconds and memory are those of the run that made it.";
        section(&mut out, "figures", "Figures", lead, &table);
    }
    document("Batch", &out)
}

fn failures(batch: &Batch) -> impl Iterator<Item = (&str, &str)> {
    batch.jobs.iter().filter_map(|ended| match &ended.outcome {
        Outcome::Failed(reason) => Some((ended.job.name.as_str(), reason.as_str())),
        _ => None,
    })
}

/// A picture with the name below it, and what is most worth knowing.
fn plate(record: &Record, figures: &Value, place: &Place) -> String {
    let path = place.of(&record.name).join(PICTURE);
    let picture = match embedded(&path) {
        Some(address) => format!(r#"<img src="{address}" alt="{}">"#, escape(&record.name)),
        None => String::new(),
    };
    let [_, after, gain] = psnr(figures);
    let after = after.map_or(String::new(), |after| format!("{} dB", decimal(after, 2)));
    let gain = gain.map_or(String::new(), |gain| format!(" ({gain:+.2})"));
    format!(
        r#"<figure><div class="frame">{picture}</div><figcaption>{} <b>{after}</b>{gain}</figcaption></figure>"#,
        escape(&record.name)
    )
}

/// As a `data:` address; none where there is no such picture.
fn embedded(path: &Path) -> Option<String> {
    if std::fs::metadata(path).ok()?.len() > LARGEST_PICTURE {
        return None;
    }
    let mut address = String::from("data:image/png;base64,");
    base64(&std::fs::read(path).ok()?, &mut address);
    Some(address)
}

fn row(ended: &Ended, record: &Record, figures: &Value) -> [String; HEAD.len()] {
    let number = |value: Option<f64>, decimals| value.map_or(String::new(), |value| decimal(value, decimals));
    let [before, after, gain] = psnr(figures);
    let triangles = ["/low_triangles", "/triangles", "/model/file/triangles"];
    let triangles = triangles.iter().find_map(|at| figures.pointer(at)?.as_u64());
    let output = ended.job.output.as_deref();
    let bytes = record.files.iter().filter(|file| Some(file.name.as_str()) == output).map(|file| file.bytes);
    [
        escape(&record.name),
        escape(&ended.job.command),
        number(before, 2),
        number(after, 2),
        gain.map_or(String::new(), |gain| format!("{gain:+.2}")),
        triangles.map_or(String::new(), |triangles| count(triangles as usize)),
        bytes.reduce(|a, b| a + b).map_or(String::new(), |bytes| count(bytes as usize)),
        decimal(record.seconds, 1),
        record
            .peak_memory
            .map_or(String::new(), |bytes| format!("{} MB", count((bytes / 1_000_000) as usize))),
    ]
}

/// PSNR before, after and gained, as far as a command's figures have it.
fn psnr(figures: &Value) -> [Option<f64>; 3] {
    let at = |pointer: &str| figures.pointer(pointer).and_then(Value::as_f64);
    let mean = "/comparison/backgrounds/0/mean";
    let (before, after) = (at(&format!("{mean}/ray_cast/psnr")), at(&format!("{mean}/baked/psnr")));
    let after = after.or(at("/mean/psnr"));
    [before, after, before.zip(after).map(|(before, after)| after - before)]
}

/// All jobs as JSON.
pub fn json(batch: &Batch) -> String {
    let job = |ended: &Ended| {
        let (state, reason) = match &ended.outcome {
            Outcome::Kept(_) | Outcome::Made(_) => ("finished", None),
            Outcome::Failed(reason) => ("failed", Some(reason)),
            Outcome::Waiting => ("waiting", None),
        };
        json!({ "name": ended.job.name, "state": state, "reason": reason, "record": ended.outcome.record() })
    };
    let jobs: Vec<Value> = batch.jobs.iter().map(job).collect();
    let document = json!({ "schema": "parbake/batch", "version": 1, "stopped": batch.stopped, "jobs": jobs });
    serde_json::to_string_pretty(&document).unwrap_or_default() + "\n"
}

/// What a person reads at the end: how many there are of each kind, and how long the finished ones took.
pub fn summary(batch: &Batch) -> String {
    let of = |is: fn(&Outcome) -> bool| batch.jobs.iter().filter(|ended| is(&ended.outcome)).count();
    let made = of(|outcome| matches!(outcome, Outcome::Made(_)));
    let kept = of(|outcome| matches!(outcome, Outcome::Kept(_)));
    let failed = failures(batch).count();
    let seconds: f64 =
        batch.jobs.iter().filter_map(|ended| ended.outcome.record()).map(|record| record.seconds).sum();
    format!("{made} made, {kept} kept, {failed} failed, {} of work in all", duration(seconds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;
    use crate::record::RecordedFile;

    /// Protects the page: failures with their sentences, escaped; figures where there are some and nothing where there
    /// are none; the picture in the page itself.
    #[test]
    fn a_page_has_all_jobs() {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::hold(folder.path(), true).unwrap();
        let job = |name: &str| Job { name: name.into(), output: Some("a.glb".into()), ..Job::default() };
        let files = vec![RecordedFile { name: "a.glb".into(), bytes: 12345, ..RecordedFile::default() }];
        let record = Record { name: "jar".into(), files, seconds: 2.5, ..Record::default() };
        std::fs::create_dir(place.of("jar")).unwrap();
        let mean = json!({ "ray_cast": { "psnr": 21.0 }, "baked": { "psnr": 23.25 } });
        let figures = json!({ "low_triangles": 500, "comparison": { "backgrounds": [{ "mean": mean }] } });
        std::fs::write(place.of("jar").join(FIGURES), figures.to_string()).unwrap();
        std::fs::write(place.of("jar").join(PICTURE), "png").unwrap();
        let plain = Record { name: "cup".into(), ..Record::default() };
        let outcomes = [
            ("jar", Outcome::Made(record)),
            ("cup", Outcome::Kept(plain)),
            ("<bad>", Outcome::Failed("no & such file".into())),
            ("late", Outcome::Waiting),
        ];
        let jobs = outcomes.map(|(name, outcome)| Ended { job: job(name), outcome }).into();
        let batch = Batch { jobs, stopped: true, page: None };
        let html = html(&batch, &place);
        for part in [
            "2 of 4 jobs",
            "&lt;bad&gt;</b> failed: no &amp; such file",
            "was stopped",
            "23.25",
            "(+2.25)",
            "base64,cG5n",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        assert!(!html.contains("NaN") && !html.contains("null"));
        assert!(summary(&batch).starts_with("1 made, 1 kept, 1 failed, 2.5"), "{}", summary(&batch));
        let json: Value = serde_json::from_str(&json(&batch)).unwrap();
        assert_eq!(
            (&json["jobs"][0]["state"], &json["jobs"][2]["reason"]),
            (&"finished".into(), &"no & such file".into())
        );
    }
}
