//! One job in a process of its own: the command, then the command that takes a picture of what it made.
//!
//! Contract: a worker does not outlive its batch, whatever ends that: dropping a [`Worker`] kills it, and its standard
//! input is a pipe that closes with this process ([`crate::LEASH`]). Ctrl-C in a terminal does not reach it, since it
//! has a process group of its own: the batch decides.

use crate::LEASH;
use crate::memory::of_process;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Instant;

/// How a job is run.
pub struct Task<'a> {
    /// The program.
    pub program: &'a Path,
    /// Arguments of the command.
    pub command: Vec<String>,
    /// Arguments of what takes the picture; its failure is none of the job's.
    pub picture: Option<Vec<String>>,
    /// The folder to run in.
    pub folder: PathBuf,
    /// The file for what it says.
    pub messages: PathBuf,
    /// Threads that it may use.
    pub threads: usize,
}

/// A running job.
pub struct Worker<'a> {
    task: Task<'a>,
    child: Child,
    begin: Instant,
    /// Of the command; none while it runs.
    seconds: Option<f64>,
    held: u64,
    peak: Option<u64>,
}

/// A job that has ended well.
#[derive(Clone, Copy, Debug)]
pub struct Done {
    /// Of the command.
    pub seconds: f64,
    /// Bytes, where the system tells.
    pub peak: Option<u64>,
}

impl<'a> Worker<'a> {
    /// Starts it.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn start(task: Task<'a>) -> io::Result<Self> {
        let child = start(&task, &task.command, File::create(&task.messages)?)?;
        Ok(Self { task, child, begin: Instant::now(), seconds: None, held: 0, peak: None })
    }

    /// The folder that it runs in.
    pub fn folder(&self) -> &Path {
        &self.task.folder
    }

    /// Memory that it holds, in bytes.
    pub fn held(&self) -> u64 {
        self.held
    }

    /// Whether it has ended, and how; the error is a sentence.
    pub fn poll(&mut self) -> Option<Result<Done, String>> {
        if let Some((held, peak)) = of_process(self.child.id()).filter(|_| self.seconds.is_none()) {
            self.held = held;
            self.peak = self.peak.max(Some(peak));
        }
        let status = match self.child.try_wait() {
            Ok(status) => status?,
            Err(error) => return Some(Err(format!("the worker was lost: {error}"))),
        };
        if self.seconds.is_some() {
            // The picture is taken, or there is none.
            return Some(Ok(self.done()));
        }
        if !status.success() {
            let said = std::fs::read(&self.task.messages).unwrap_or_default();
            return Some(Err(sentence(&String::from_utf8_lossy(&said), status)));
        }
        self.seconds = Some(self.begin.elapsed().as_secs_f64());
        let picture = self.task.picture.take().and_then(|line| {
            let messages = File::options().append(true).open(&self.task.messages).ok()?;
            start(&self.task, &line, messages).ok()
        });
        match picture {
            Some(child) => {
                self.child = child;
                None
            }
            None => Some(Ok(self.done())),
        }
    }

    fn done(&self) -> Done {
        Done { seconds: self.seconds.unwrap_or_default(), peak: self.peak }
    }
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        // Of one that has ended neither does anything.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn start(task: &Task<'_>, line: &[String], messages: File) -> io::Result<Child> {
    let mut command = Command::new(task.program);
    command.args(line).current_dir(&task.folder);
    command.env(LEASH, "1").env("RAYON_NUM_THREADS", task.threads.to_string());
    command.stdin(Stdio::piped()).stdout(messages.try_clone()?).stderr(messages);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command.spawn()
}

/// What a job that failed has said last, or how it was ended.
fn sentence(said: &str, status: ExitStatus) -> String {
    let lines = || said.lines().map(str::trim).filter(|line| !line.is_empty());
    if let Some(error) = lines().rev().find_map(|line| line.strip_prefix("error: ")) {
        return error.into();
    }
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let why = if signal == 9 { ", as when memory runs out" } else { "" };
        return format!("it was ended by signal {signal}{why}");
    }
    let last = lines().next_back().map_or(String::new(), |line| format!(": {line}"));
    match status.code() {
        Some(code) => format!("exit code {code}{last}"),
        None => format!("it was ended{last}"),
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn run(script: &str) -> Result<Done, String> {
        let folder = tempfile::tempdir().unwrap();
        let task = Task {
            program: Path::new("/bin/sh"),
            command: vec!["-c".into(), script.into()],
            picture: Some(vec!["-c".into(), "echo > picture.png; exit 1".into()]),
            folder: folder.path().into(),
            messages: folder.path().join("log"),
            threads: 3,
        };
        let mut worker = Worker::start(task).unwrap();
        for _ in 0..1000 {
            if let Some(ended) = worker.poll() {
                assert!(ended.is_err() || folder.path().join("picture.png").exists());
                return ended;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("{script}")
    }

    /// Protects people from exit codes alone: the last error is told, or how the process was ended; a picture that
    /// fails is no failure; threads are those of the worker.
    #[test]
    fn failures_are_sentences() {
        assert!(run("test $RAYON_NUM_THREADS = 3 && test -n $PARBAKE_ENDS_WITH_STDIN").is_ok());
        assert_eq!(
            run("echo 'warning: x' >&2; echo 'error: no such file' >&2; exit 1").unwrap_err(),
            "no such file"
        );
        assert_eq!(run("echo not sound; exit 3").unwrap_err(), "exit code 3: not sound");
        assert!(run("kill -9 $$").unwrap_err().contains("signal 9, as when memory runs out"));
    }

    /// Protects the machine from workers that go on: one that is dropped has ended.
    #[test]
    fn a_dropped_worker_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let task = Task {
            program: Path::new("/bin/sleep"),
            command: vec!["1000".into()],
            picture: None,
            folder: folder.path().into(),
            messages: folder.path().join("log"),
            threads: 1,
        };
        let worker = Worker::start(task).unwrap();
        let id = worker.child.id();
        drop(worker);
        if cfg!(target_os = "linux") {
            assert!(!Path::new(&format!("/proc/{id}")).exists());
        }
    }
}
