//! Nobody else gets in.

use crate::running::{Running, Tested};
use std::net::{Ipv4Addr, SocketAddr, TcpStream, UdpSocket};
use std::time::Duration;

/// Every route, one of a kind.
const ROUTES: [&str; 8] = [
    "GET /",
    "GET /assets/main.js",
    "GET /api/state",
    "GET /api/overlay/0",
    "GET /api/events",
    "POST /api/do",
    "POST /api/upload?name=a.csv",
    "GET /files/workbench/steps.json",
];

#[test]
fn it_listens_on_loopback_only() -> Tested {
    let running = Running::new()?;
    assert!(running.connect().is_ok());
    // The machine's own address towards others; no packet is sent.
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    let others = socket.connect("192.0.2.1:9").and_then(|()| socket.local_addr());
    let mut tried = vec![SocketAddr::from(([127, 0, 0, 2], running.port))];
    tried
        .extend(others.ok().filter(|a| !a.ip().is_loopback()).map(|a| SocketAddr::new(a.ip(), running.port)));
    for address in tried {
        assert!(TcpStream::connect_timeout(&address, Duration::from_secs(2)).is_err(), "{address}");
    }
    Ok(())
}

#[test]
fn the_token_becomes_a_cookie_that_no_script_and_no_other_site_sees() -> Tested {
    let running = Running::new()?;
    let host = format!("Host: {}", running.host());
    let entered = running.send(&format!("GET /?token={}", running.token), &[&host], b"")?;
    assert_eq!(entered.status, 303);
    for word in ["location: /\r\n", "httponly", "samesite=strict", "path=/"] {
        assert!(entered.head.contains(word), "{word} in {}", entered.head);
    }
    assert_eq!(running.token.len(), 64);
    let page = running.own("GET /", b"")?;
    assert!(page.status == 200 && page.body.contains("main.js") && !page.body.contains(&running.token));
    // Two workbenches have two tokens.
    assert_ne!(Running::new()?.token, running.token);
    Ok(())
}

#[test]
fn without_the_token_there_is_nothing() -> Tested {
    let running = Running::new()?;
    let (host, origin) = (format!("Host: {}", running.host()), format!("Origin: http://{}", running.host()));
    let wrong = running.cookie().replace(&running.token, &"0".repeat(64));
    let short = running.cookie().replace(&running.token, &running.token[..63]);
    let other = running.cookie().replace("fct-workbench", "other");
    let address = format!("Cookie: token={}", running.token);
    for route in ROUTES {
        for cookie in ["X-None: 1", &wrong, &short, &other, &address] {
            let answer = running.send(route, &[&host, &origin, cookie], b"{\"do\":\"fit\"}")?;
            assert_eq!(answer.status, 403, "{route} with {cookie}");
        }
    }
    for token in ["", "0", &running.token[1..], &running.token.to_uppercase().replace(char::is_numeric, "x")]
    {
        let answer = running.send(&format!("GET /?token={token}"), &[&host], b"")?;
        assert!(answer.status == 403 && !answer.head.contains("set-cookie"), "{token}");
    }
    // The token in the address opens nothing but the entrance.
    let state = running.send(&format!("GET /api/state?token={}", running.token), &[&host], b"")?;
    assert_eq!(state.status, 403);
    assert!(running.commands.heard.lock().is_ok_and(|h| h.is_empty()), "no command was run");
    Ok(())
}

#[test]
fn another_host_gets_nothing_on_any_route() -> Tested {
    let running = Running::new()?;
    let (cookie, port) = (running.cookie(), running.port);
    let token = format!("GET /?token={}", running.token);
    for route in ROUTES.iter().copied().chain([token.as_str()]) {
        for host in [
            format!("evil.example:{port}"),
            format!("127.0.0.1.evil.example:{port}"),
            "127.0.0.1".to_owned(),
            format!("127.0.0.1:{}", port ^ 1),
            format!("localhost.:{port}"),
            format!("user@127.0.0.1:{port}"),
        ] {
            let (named, origin) = (format!("Host: {host}"), format!("Origin: http://{host}"));
            let answer = running.send(route, &[&named, &origin, &cookie], b"{}")?;
            assert_eq!(answer.status, 403, "{route} at {host}");
        }
        let own = format!("Host: 127.0.0.1:{port}");
        let two = running.send(route, &[&own, "Host: evil.example", &cookie], b"{}")?;
        assert!(two.status >= 400, "{route} with two hosts");
    }
    let absolute = format!("GET http://evil.example:{port}/api/state");
    let own = format!("Host: 127.0.0.1:{port}");
    assert_eq!(running.send(&absolute, &[&own, &cookie], b"")?.status, 403);
    for host in [format!("localhost:{port}"), format!("[::1]:{port}")] {
        let answer = running.send("GET /api/state", &[&format!("Host: {host}"), &cookie], b"")?;
        assert_eq!(answer.status, 200, "{host}");
    }
    Ok(())
}

#[test]
fn another_origin_gets_nothing() -> Tested {
    let running = Running::new()?;
    let (host, cookie) = (format!("Host: {}", running.host()), running.cookie());
    let own = format!("Origin: http://{}", running.host());
    for origin in ["Origin: http://evil.example", "Origin: null", "Origin: http://127.0.0.1:1", "X-None: 1"] {
        let answer = running.send("POST /api/do", &[&host, &cookie, origin], b"{\"do\":\"fit\"}")?;
        assert_eq!(answer.status, 403, "{origin}");
    }
    for site in ["cross-site", "same-site", "none"] {
        let site = format!("Sec-Fetch-Site: {site}");
        assert_eq!(
            running.send("POST /api/do", &[&host, &cookie, &own, &site], b"{\"do\":\"fit\"}")?.status,
            403
        );
    }
    for get in ["GET /api/state", "GET /api/events"] {
        let answer = running.send(get, &[&host, &cookie, "Origin: http://evil.example"], b"")?;
        assert_eq!(answer.status, 403, "{get}");
        assert_eq!(running.send(get, &[&host, &cookie, "Sec-Fetch-Site: cross-site"], b"")?.status, 403);
    }
    // No CORS: nobody is told that they may.
    let asked = ["Access-Control-Request-Method: POST", "Origin: http://evil.example", &host, &cookie];
    let preflight = running.send("OPTIONS /api/do", &asked, b"")?;
    assert!(
        preflight.status >= 400 && !preflight.head.contains("access-control-allow"),
        "{}",
        preflight.head
    );
    assert!(running.own("GET /api/state", b"")?.head.contains("cross-origin-resource-policy: same-origin"));
    // A link to an action does nothing.
    assert_eq!(running.own("GET /api/do", b"")?.status, 405);
    assert!(running.commands.heard.lock().is_ok_and(|h| h.is_empty()), "no command was run");
    Ok(())
}

#[test]
fn nothing_runs_on_the_page_but_its_own_files() -> Tested {
    let running = Running::new()?;
    for route in
        ["GET /", "GET /assets/main.js", "GET /api/state", "GET /nothing", "GET /files/workbench/steps.json"]
    {
        let head = running.own(route, b"")?.head;
        assert!(head.contains("script-src 'self';") && !head.contains("unsafe"), "{route}: {head}");
        assert!(head.contains("nosniff") && head.contains("frame-ancestors 'none'"), "{route}: {head}");
    }
    let page = running.own("GET /", b"")?.body;
    assert_eq!(
        page.matches("<script").count(),
        page.matches("<script type=\"module\" src=\"/assets/").count()
    );
    assert!(!page.contains(" style=") && !page.contains(" on") && !page.contains("//"), "{page}");
    // A file of the folder is saved, not shown: markup in it would be ours.
    let file = running.own("GET /files/workbench/steps.json", b"")?.head;
    assert!(file.contains("attachment") && file.contains("octet-stream"), "{file}");
    Ok(())
}

#[test]
fn no_path_leaves_the_folder() -> Tested {
    let running = Running::new()?;
    let outer = tempfile::tempdir()?;
    std::fs::write(outer.path().join("secret"), "the secret")?;
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outer.path(), running.path().join("way"))?;
        std::os::unix::fs::symlink(outer.path().join("secret"), running.path().join("link"))?;
    }
    let name = outer.path().file_name().ok_or("a name")?.to_string_lossy().into_owned();
    for path in [
        format!("../{name}/secret"),
        format!("..%2f{name}%2fsecret"),
        format!("%2e%2e/{name}/secret"),
        format!("workbench/../../{name}/secret"),
        format!("/{}/secret", outer.path().display()),
        "way/secret".into(),
        "link".into(),
        "%2fetc%2fpasswd".into(),
        "..%5csecret".into(),
        "workbench/steps.json%00.csv".into(),
    ] {
        let answer = running.own(&format!("GET /files/{path}"), b"")?;
        assert!(answer.status >= 400 && !answer.body.contains("the secret"), "{path}: {}", answer.status);
    }
    // Uploads stay in the folder of uploads, whatever they are called.
    for name in ["..%2f..%2fevil.csv", "%2ftmp%2fevil.csv", ".hidden", "a%00b"] {
        let answer = running.own(&format!("POST /api/upload?name={name}"), b"1,2\n")?;
        assert!(answer.status == 200 && answer.body.contains("workbench/raw/"), "{name}: {}", answer.body);
    }
    assert!(!running.path().join("evil.csv").exists() && !running.path().join("workbench/evil.csv").exists());
    // An import of a file elsewhere is refused before any command.
    let asked = r#"{"do":"import","files":["../etc/passwd"],"kinds":["tearing"]}"#;
    assert_eq!(running.own("POST /api/do", asked.as_bytes())?.status, 200);
    std::thread::sleep(Duration::from_millis(300));
    assert!(running.commands.heard.lock().is_ok_and(|h| h.is_empty()), "no command was run");
    Ok(())
}

#[test]
fn bodies_have_an_end() -> Tested {
    let running = Running::new()?;
    let most = workbench::LARGEST_BODY;
    let full = vec![b'1'; most];
    assert_eq!(running.own("POST /api/upload?name=full", &full)?.status, 200);
    let over = vec![b'1'; most + 1];
    assert_eq!(running.own("POST /api/upload?name=over", &over)?.status, 413);
    assert!(!running.path().join("workbench/raw/over").exists());
    assert_eq!(running.own("POST /api/do", &vec![b' '; (1 << 20) + 1])?.status, 413);
    for bad in
        ["", "{", "[]", "{\"do\":\"eat\"}", "{\"do\":\"go\",\"step\":7}", "{\"do\":\"go\",\"step\":-1}"]
    {
        assert_eq!(running.own("POST /api/do", bad.as_bytes())?.status, 400, "{bad}");
    }
    Ok(())
}
