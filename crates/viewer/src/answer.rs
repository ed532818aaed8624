//! The answer to one request.
//!
//! Contract: nothing is answered but GET requests of this machine's own page. Every answer forbids the browser to
//! guess its type, to keep it, and to hand the address on; the page may load nothing from anywhere else.

use crate::live::Live;
use crate::models::Entry;
use crate::routes::{Route, RunRoute, route};
use bytes::Bytes;
use http_body_util::Full;
use hyper::header::{
    ALLOW, CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, HeaderName, HeaderValue,
    REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use hyper::{HeaderMap, Method, Response, StatusCode};
use serde_json::{Value, json};
use std::sync::Arc;

/// Scripts and styles are the page's own files. Decoders of meshes and textures are WebAssembly, run in workers made
/// from text, one of which holds its own bytes as data; textures inside models become blobs.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
img-src 'self' blob: data:; connect-src 'self' blob: data:; worker-src 'self' blob:; frame-ancestors 'none'; base-uri 'none'; \
form-action 'none'";

/// The same for the worker that decodes KTX2: it alone may make functions from text, and may load nothing at all.
const WORKER_POLICY: &str = "default-src 'none'; script-src 'unsafe-eval' 'wasm-unsafe-eval'";

/// What a server serves.
#[derive(Debug)]
pub(crate) struct Shown {
    /// What every path begins with.
    pub token: String,
    /// The only host that may be asked: an address with the port.
    pub host: String,
    pub models: Vec<Entry>,
    /// A run that is followed.
    pub live: Option<Arc<Live>>,
}

pub(crate) type Answer = Response<Full<Bytes>>;

/// The answer to a request.
pub(crate) async fn answer(shown: &Shown, method: &Method, path: &str, headers: &HeaderMap) -> Answer {
    // A page whose own name was pointed at this machine asks for another host; a page of another site says so.
    let host = headers.get(HOST).and_then(|host| host.to_str().ok());
    let site = headers.get("sec-fetch-site").and_then(|site| site.to_str().ok()).unwrap_or("none");
    if host != Some(&shown.host) || !matches!(site, "none" | "same-origin") {
        return refused(StatusCode::FORBIDDEN, "This page is for this machine's own browser.");
    }
    if method != Method::GET {
        let mut answer = refused(StatusCode::METHOD_NOT_ALLOWED, "Only GET is answered.");
        answer.headers_mut().insert(ALLOW, HeaderValue::from_static("GET"));
        return answer;
    }
    let Some(route) = route(path, &shown.token, shown.models.len(), shown.live.is_some()) else {
        return refused(
            StatusCode::NOT_FOUND,
            "There is nothing here. Use the whole address that parbake printed.",
        );
    };
    if let Some(live) = &shown.live {
        live.note_page();
    }
    let answer = routed(shown, route).await;
    // What takes long to answer was asked for long ago.
    if let Some(live) = &shown.live {
        live.note_page();
    }
    answer
}

async fn routed(shown: &Shown, route: Route) -> Answer {
    match route {
        Route::Page(file) => {
            let mut answer = reply(StatusCode::OK, file.media_type, Bytes::from_static(file.bytes));
            if file.evaluates_text() {
                answer.headers_mut().insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(WORKER_POLICY));
            }
            answer
        }
        Route::Session => document(StatusCode::OK, &session(shown)),
        Route::Model(index) => match shown.models[index].ready().await {
            Ok(model) => reply(StatusCode::OK, "model/gltf-binary", model.glb.clone()),
            Err(reason) => document(StatusCode::UNPROCESSABLE_ENTITY, &json!({ "error": reason })),
        },
        Route::Notes(index) => match shown.models[index].ready().await {
            Ok(model) => {
                document(StatusCode::OK, &json!({ "bytes": model.bytes, "warnings": model.warnings }))
            }
            Err(reason) => document(StatusCode::UNPROCESSABLE_ENTITY, &json!({ "error": reason })),
        },
        Route::Run(asked) => match &shown.live {
            Some(live) => of_run(live, asked).await,
            None => refused(StatusCode::NOT_FOUND, "No run is followed here."),
        },
    }
}

async fn of_run(live: &Live, asked: RunRoute) -> Answer {
    match asked {
        RunRoute::News(version) => document(StatusCode::OK, &live.news(version, false).await),
        RunRoute::NewsAndSnapshot(version) => document(StatusCode::OK, &live.news(version, true).await),
        RunRoute::Snapshot => match live.glb().await {
            Some(glb) => reply(StatusCode::OK, "model/gltf-binary", glb),
            None => refused(StatusCode::NOT_FOUND, "There is nothing to see of this run yet."),
        },
        RunRoute::Shown => {
            live.take_over();
            document(StatusCode::OK, &Value::Null)
        }
    }
}

fn session(shown: &Shown) -> Value {
    let of = |(index, entry): (usize, &Entry)| {
        let (url, notes) = (format!("model/{index}"), format!("model/{index}/notes.json"));
        json!({ "name": entry.name(), "role": entry.role.name(), "url": url, "notes": notes })
    };
    let models: Vec<Value> = shown.models.iter().enumerate().map(of).collect();
    let live = shown.live.as_ref().map(|live| json!({ "name": live.name() }));
    json!({ "version": env!("CARGO_PKG_VERSION"), "models": models, "live": live })
}

fn document(status: StatusCode, value: &Value) -> Answer {
    reply(status, "application/json", value.to_string().into())
}

fn refused(status: StatusCode, sentence: &'static str) -> Answer {
    reply(status, "text/plain; charset=utf-8", Bytes::from_static(sentence.as_bytes()))
}

fn reply(status: StatusCode, media_type: &'static str, body: Bytes) -> Answer {
    let mut answer = Response::new(Full::new(body));
    *answer.status_mut() = status;
    let headers: [(HeaderName, &'static str); 7] = [
        (CONTENT_TYPE, media_type),
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        (CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ];
    for (name, value) in headers {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    answer
}
