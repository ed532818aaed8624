//! A batch as a job template of Open Job Description (specification 2023-09), which render farms run.
//!
//! Each task is `parbake batch … --only NAME`: the same command line, key and record as in a batch of one's own, so
//! tasks may run anywhere and again, on a shared disk. A batch after them finds all finished and draws the page.
//!
//! Contract: a step for each [`MOST_VALUES`] jobs, since a task parameter has no more values.

use crate::error::BatchError;
use crate::job::Job;
use serde_json::{Value, json};

/// Values that a task parameter may have at most.
const MOST_VALUES: usize = 1024;

/// The batch's own command line around a job's name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TaskCommand {
    /// Arguments before `--only NAME`: `batch`, the jobs file, …
    pub before: Vec<String>,
    /// Arguments after it.
    pub after: Vec<String>,
}

/// The template as JSON.
///
/// # Errors
/// Where an argument or a name holds what a template takes for its own.
pub fn openjd_template(name: &str, jobs: &[Job], command: &TaskCommand) -> Result<String, BatchError> {
    let texts = command.before.iter().chain(&command.after).chain(jobs.iter().map(|job| &job.name));
    if let Some(text) = texts.into_iter().find(|text| text.contains("{{")) {
        let reason = format!("{text:?} holds {{{{, which a job template would take for its own; rename it");
        return Err(BatchError::Option(reason));
    }
    let only = ["--only".to_string(), "{{Task.Param.Job}}".into()];
    let arguments: Vec<&String> = command.before.iter().chain(&only).chain(&command.after).collect();
    let several = jobs.len() > MOST_VALUES;
    let step = |(number, jobs): (usize, &[Job])| {
        let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
        json!({
            "name": if several { format!("Jobs {}", number + 1) } else { "Jobs".into() },
            "parameterSpace": { "taskParameterDefinitions": [{ "name": "Job", "type": "STRING", "range": names }] },
            "script": { "actions": { "onRun": { "command": "{{Param.Parbake}}", "args": arguments } } },
        })
    };
    let steps: Vec<Value> = jobs.chunks(MOST_VALUES).enumerate().map(step).collect();
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": name.chars().take(128).collect::<String>(),
        "parameterDefinitions": [{
            "name": "Parbake",
            "type": "STRING",
            "default": "parbake",
            "description": "The program, by name or path",
        }],
        "steps": steps,
    });
    Ok(serde_json::to_string_pretty(&template).unwrap_or_default() + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects farms: a task for each job, in steps that the specification allows, with the whole command line.
    #[test]
    fn each_job_is_a_task() {
        let jobs: Vec<Job> = (0..1500).map(|i| Job { name: format!("job {i}"), ..Job::default() }).collect();
        let command = TaskCommand {
            before: vec!["batch".into(), "/x/jobs.toml".into()],
            after: vec!["--".into(), "-v".into()],
        };
        let template: Value =
            serde_json::from_str(&openjd_template("all", &jobs, &command).unwrap()).unwrap();
        let steps = template["steps"].as_array().unwrap();
        let values = |step: &Value| {
            step["parameterSpace"]["taskParameterDefinitions"][0]["range"].as_array().unwrap().len()
        };
        assert_eq!(steps.iter().map(values).collect::<Vec<_>>(), [1024, 476]);
        assert_eq!((&steps[0]["name"], &steps[1]["name"]), (&"Jobs 1".into(), &"Jobs 2".into()));
        let wanted = ["batch", "/x/jobs.toml", "--only", "{{Task.Param.Job}}", "--", "-v"];
        assert_eq!(steps[0]["script"]["actions"]["onRun"]["args"], json!(wanted));
        let odd = [Job { name: "{{Param.X}}".into(), ..Job::default() }];
        assert!(openjd_template("all", &odd, &command).is_err());
    }
}
