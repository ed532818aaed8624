//! Listens on this machine and hands requests on.

use crate::answer::{Shown, answer};
use crate::models::{Entry, Role};
use crate::{Live, ViewError};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use parbake_files::Limits;
use std::convert::Infallible;
use std::fmt::Write;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Bytes of the token in the address.
const TOKEN: usize = 16;
/// How long a connection may take to say what it wants.
const PATIENCE: Duration = Duration::from_secs(20);

/// What is to be viewed.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// The model; several files are its levels of detail, the finest first. None where a run is followed.
    pub levels: Vec<PathBuf>,
    /// A run whose result is shown while it is made. Default: none.
    pub live: Option<Arc<Live>>,
    /// What it is compared with. Default: nothing.
    pub compare: Option<PathBuf>,
    /// Port to listen on; 0, the default, takes any that is free.
    pub port: u16,
    /// What models may ask for.
    pub limits: Limits,
}

/// A viewer that listens already and answers as soon as it [runs](Server::run).
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    shown: Arc<Shown>,
}

impl Server {
    /// Listens on 127.0.0.1. No model is read yet.
    ///
    /// # Errors
    /// A port that cannot be listened on; no random numbers.
    pub fn bind(view: &View) -> Result<Self, ViewError> {
        let refused = |source| ViewError::Port { port: view.port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, view.port)).map_err(refused)?;
        let host = listener.local_addr().map_err(refused)?.to_string();
        let levels = view.levels.iter().map(|path| Entry::new(path, Role::Level, view.limits));
        let compare = view.compare.iter().map(|path| Entry::new(path, Role::Compare, view.limits));
        let models = levels.chain(compare).collect();
        let live = view.live.clone();
        Ok(Self { listener, shown: Arc::new(Shown { token: token()?, host, models, live }) })
    }

    /// The page's address. Who knows it can read the models.
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.shown.host, self.shown.token)
    }

    /// Where it listens.
    ///
    /// # Errors
    /// That of the operating system.
    pub fn address(&self) -> std::io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// Reads the models and answers, until the process ends.
    ///
    /// # Errors
    /// When the operating system gives no event loop.
    pub fn run(self) -> Result<Infallible, ViewError> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(ViewError::Start)?;
        runtime.block_on(serve(self.listener, self.shown))
    }
}

async fn serve(listener: TcpListener, shown: Arc<Shown>) -> Result<Infallible, ViewError> {
    listener.set_nonblocking(true).map_err(ViewError::Start)?;
    let listener = tokio::net::TcpListener::from_std(listener).map_err(ViewError::Start)?;
    // Beside a run nothing is read before a page asks.
    let at_once = if shown.live.is_some() { 0 } else { shown.models.len() };
    for index in 0..at_once {
        let shown = shown.clone();
        tokio::spawn(async move {
            shown.models[index].ready().await;
        });
    }
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Too many open files, most likely: others will close.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let shown = shown.clone();
        tokio::spawn(async move {
            let service = service_fn(|request: hyper::Request<hyper::body::Incoming>| {
                let shown = shown.clone();
                async move {
                    let path = request.uri().path();
                    Ok::<_, Infallible>(answer(&shown, request.method(), path, request.headers()).await)
                }
            });
            // A browser that goes away is no error of ours.
            let _ = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(PATIENCE)
                .serve_connection(TokioIo::new(stream), service)
                .await;
        });
    }
}

fn token() -> Result<String, ViewError> {
    let mut bytes = [0; TOKEN];
    getrandom::fill(&mut bytes).map_err(|error| ViewError::Random(error.to_string()))?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to text cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

/// Opens an address in the user's browser.
///
/// # Errors
/// When no browser can be started.
pub fn open_browser(url: &str) -> Result<(), ViewError> {
    open::that_detached(url).map_err(ViewError::Browser)
}
