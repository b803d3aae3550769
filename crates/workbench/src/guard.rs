//! Who gets in.
//!
//! Loopback alone is not enough: any page in the user's browser can send requests to 127.0.0.1, and a name that resolves to it
//! (DNS rebinding) makes them same-origin. So every request must name this server as its host, carry the token's cookie
//! (`HttpOnly`, `SameSite=Strict`), and come from this page where it changes anything.

use crate::routes::App;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Headers of every answer.
const ALWAYS: [(HeaderName, &str); 6] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// The token of a running workbench, and its address.
#[derive(Clone, Debug)]
pub struct Gate {
    /// Port.
    pub port: u16,
    /// 64 hexadecimal digits.
    pub token: String,
}

impl Gate {
    /// Cookies do not know ports: each workbench has its own name.
    pub fn cookie(&self) -> String {
        format!("fct-workbench-{}", self.port)
    }

    /// Whether this is the token; takes as long wherever a guess goes wrong.
    pub fn opens(&self, token: &str) -> bool {
        let (a, b) = (token.as_bytes(), self.token.as_bytes());
        a.len() == b.len() && a.iter().zip(b).fold(0, |d, (x, y)| d | (x ^ y)) == 0
    }

    fn is_host(&self, host: &str) -> bool {
        ["127.0.0.1", "localhost", "[::1]"].iter().any(|h| *host == format!("{h}:{}", self.port))
    }

    /// The host of a request, if it is this server.
    fn host<'r>(&self, request: &'r Request) -> Option<&'r str> {
        let named = only(request.headers(), &header::HOST)?;
        let absolute = request.uri().authority().is_none_or(|a| self.is_host(a.as_str()));
        (absolute && self.is_host(named)).then_some(named)
    }

    fn has_cookie(&self, headers: &HeaderMap) -> bool {
        let name = self.cookie();
        let all = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
        all.flat_map(|v| v.split(';'))
            .filter_map(|c| c.trim().split_once('='))
            .any(|(n, v)| n == name && self.opens(v))
    }
}

/// The value of a header that stands there once.
fn only<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?.to_str().ok()?;
    all.next().is_none().then_some(first)
}

/// Whether the request comes from the page itself, or from the address bar where nothing changes.
fn is_own(request: &Request, host: &str) -> bool {
    let headers = request.headers();
    let changes = request.method() != Method::GET && request.method() != Method::HEAD;
    let origin = headers.contains_key(header::ORIGIN);
    let same = only(headers, &header::ORIGIN).is_some_and(|o| o == format!("http://{host}"));
    let site = HeaderName::from_static("sec-fetch-site");
    let from = !headers.contains_key(&site)
        || only(headers, &site).is_some_and(|s| s == "same-origin" || (s == "none" && !changes));
    from && if changes { same } else { same || !origin }
}

/// The only way in.
pub async fn guard(State(app): State<App>, request: Request, next: Next) -> Response {
    let refuse = |why: &'static str| (StatusCode::FORBIDDEN, why).into_response();
    let mut answer = match app.gate.host(&request) {
        None => refuse("wrong host\n"),
        // The address that was opened: a link to it from elsewhere is let through to the token, nothing else.
        Some(_) if is_entrance(&request) => next.run(request).await,
        Some(_) if !app.gate.has_cookie(request.headers()) => refuse(crate::assets::NO_TOKEN),
        Some(host) if !is_own(&request, host) => refuse("wrong origin\n"),
        Some(_) => next.run(request).await,
    };
    for (name, value) in ALWAYS {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    answer
}

fn is_entrance(request: &Request) -> bool {
    request.method() == Method::GET
        && request.uri().path() == "/"
        && request.uri().query().is_some_and(|q| q.starts_with("token="))
}

/// The answer to the opened address: the cookie, and the page without the token in its address.
pub fn entered(gate: &Gate, token: &str) -> Response {
    if !gate.opens(token) {
        return (StatusCode::FORBIDDEN, crate::assets::NO_TOKEN).into_response();
    }
    let cookie = format!("{}={}; Path=/; HttpOnly; SameSite=Strict", gate.cookie(), gate.token);
    Response::builder()
        .status(StatusCode::SEE_OTHER)
        .header(header::LOCATION, "/")
        .header(header::SET_COOKIE, cookie)
        .body(Body::empty())
        .unwrap_or_default()
}
