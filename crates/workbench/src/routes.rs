//! Addresses of the server.

use crate::action::Action;
use crate::bench::Bench;
use crate::guard::{Gate, entered, guard};
use crate::{BenchError, LARGEST_BODY, assets, view};
use axum::Router;
use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// Largest body that asks for something, bytes; files are larger.
const LARGEST_ACTION: usize = 1 << 20;
/// Longest time that a body may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// What handlers need.
#[derive(Clone)]
pub struct App {
    /// The workbench.
    pub bench: Arc<Bench>,
    /// Who gets in.
    pub gate: Arc<Gate>,
}

type Named = Query<HashMap<String, String>>;

/// Every route, behind the guard.
pub fn router(app: App) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/assets/{name}", get(asset))
        .route("/api/state", get(state))
        .route("/api/overlay/{step}", get(overlay))
        .route("/api/events", get(events))
        .route("/api/do", post(ask))
        .route("/api/upload", post(upload))
        .route("/files/{*path}", get(file))
        .fallback(nothing)
        .layer(from_fn_with_state(app.clone(), guard))
        .with_state(app)
}

async fn nothing() -> Response {
    told(StatusCode::NOT_FOUND, &json!({ "error": "nothing here" }))
}

async fn page(State(app): State<App>, Query(query): Named) -> Response {
    match query.get("token") {
        Some(token) => entered(&app.gate, token),
        None => content("text/html; charset=utf-8", assets::PAGE),
    }
}

async fn asset(Path(name): Path<String>) -> Response {
    match assets::asset(&name) {
        Some((kind, text)) => content(kind, text),
        None => nothing().await,
    }
}

fn content(kind: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, kind)], text).into_response()
}

fn told(status: StatusCode, json: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], json.to_string()).into_response()
}

/// Work that may wait for the disk, beside the server's thread.
async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, Response> {
    let failed =
        |_| told(StatusCode::INTERNAL_SERVER_ERROR, &json!({ "error": "this is a fault of fct itself" }));
    tokio::task::spawn_blocking(work).await.map_err(failed)
}

fn answered(done: Result<Value, BenchError>) -> Response {
    match done {
        Ok(json) => told(StatusCode::OK, &json),
        Err(e) => told(StatusCode::BAD_REQUEST, &json!({ "error": e.to_string() })),
    }
}

async fn state(State(app): State<App>) -> Response {
    match aside(move || view::state(&app.bench)).await {
        Ok(state) => told(StatusCode::OK, &state),
        Err(failed) => failed,
    }
}

async fn overlay(State(app): State<App>, Path(step): Path<usize>) -> Response {
    match aside(move || view::overlay(&app.bench, step)).await {
        Ok(found) => answered(found),
        Err(failed) => failed,
    }
}

async fn events(State(app): State<App>) -> Response {
    let kind = [(header::CONTENT_TYPE, "text/event-stream")];
    (kind, Body::from_stream(app.bench.hub.listen())).into_response()
}

/// The whole body; one that is too large is refused before it is read where it says so.
async fn whole(headers: &HeaderMap, body: Body, most: usize) -> Result<Bytes, Response> {
    let too_large =
        || told(StatusCode::PAYLOAD_TOO_LARGE, &json!({ "error": format!("more than {most} bytes") }));
    let said = headers.get(header::CONTENT_LENGTH).and_then(|v| v.to_str().ok()?.parse::<u64>().ok());
    if said.is_some_and(|n| n > most as u64) {
        return Err(too_large());
    }
    match tokio::time::timeout(PATIENCE, to_bytes(body, most)).await {
        Ok(Ok(bytes)) => Ok(bytes),
        Ok(Err(_)) => Err(too_large()),
        Err(_) => Err(told(StatusCode::REQUEST_TIMEOUT, &json!({ "error": "too slow" }))),
    }
}

async fn ask(State(app): State<App>, headers: HeaderMap, body: Body) -> Response {
    let bytes = match whole(&headers, body, LARGEST_ACTION).await {
        Ok(bytes) => bytes,
        Err(refused) => return refused,
    };
    let action: Action = match serde_json::from_slice(&bytes) {
        Ok(action) => action,
        Err(e) => return told(StatusCode::BAD_REQUEST, &json!({ "error": e.to_string() })),
    };
    match aside(move || app.bench.ask(action)).await {
        Ok(done) => answered(done.map(|()| json!({}))),
        Err(failed) => failed,
    }
}

async fn upload(State(app): State<App>, Query(query): Named, headers: HeaderMap, body: Body) -> Response {
    let name = query.get("name").cloned().unwrap_or_default();
    match whole(&headers, body, LARGEST_BODY).await {
        Err(refused) => refused,
        Ok(bytes) => match aside(move || app.bench.keep(&name, &bytes)).await {
            Ok(kept) => answered(kept.map(|file| json!({ "file": file }))),
            Err(failed) => failed,
        },
    }
}

/// A file of the opened folder, to be saved, never shown: what stands in it does not run here.
async fn file(State(app): State<App>, Path(path): Path<String>) -> Response {
    let read = move || {
        app.bench.opened.inside(&path).and_then(|p| std::fs::read(&p).map_err(BenchError::io(p, "read")))
    };
    let saved =
        [(header::CONTENT_TYPE, "application/octet-stream"), (header::CONTENT_DISPOSITION, "attachment")];
    match aside(read).await {
        Ok(Ok(bytes)) => (saved, bytes).into_response(),
        Ok(Err(e)) => told(StatusCode::NOT_FOUND, &json!({ "error": e.to_string() })),
        Err(failed) => failed,
    }
}
