//! Who is slow, and who is many, keeps nobody else waiting.

use crate::running::{Running, Tested};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

#[test]
fn half_a_request_blocks_nobody() -> Tested {
    let running = Running::new()?;
    let (host, cookie) = (running.host(), running.cookie());
    let mut held = Vec::new();
    for half in [
        String::new(),
        "GET /api/sta".into(),
        format!("GET /api/state HTTP/1.1\r\nHost: {host}\r\n"),
        format!(
            "POST /api/do HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n{cookie}\r\nContent-Length: 1000\r\n\r\n{{"
        ),
    ] {
        let mut stream = running.connect()?;
        stream.write_all(half.as_bytes())?;
        held.push(stream);
    }
    let begun = Instant::now();
    running.state()?;
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    Ok(())
}

#[test]
fn two_hundred_connections_block_nobody() -> Tested {
    let running = Running::new()?;
    let mut held = Vec::new();
    for k in 0..200 {
        let mut stream = running.connect()?;
        // Half of them listen to the events, as pages do; half say nothing.
        if k % 2 == 0 {
            let (host, cookie) = (running.host(), running.cookie());
            write!(stream, "GET /api/events HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n\r\n")?;
        }
        held.push(stream);
    }
    let begun = Instant::now();
    running.state()?;
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    Ok(())
}

#[test]
fn events_arrive_as_they_happen() -> Tested {
    let running = Running::new()?;
    let mut stream = running.connect()?;
    let (host, cookie) = (running.host(), running.cookie());
    write!(stream, "GET /api/events HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n\r\n")?;
    let mut heard = String::new();
    let mut buffer = [0; 4096];
    // Listening begins with the head of the answer.
    while !heard.contains(": here") {
        let n = stream.read(&mut buffer)?;
        heard.push_str(&String::from_utf8_lossy(&buffer[..n]));
    }
    running.own("POST /api/do", b"{\"do\":\"fit\"}")?;
    while !heard.contains("event: ended") {
        let n = stream.read(&mut buffer)?;
        assert!(n > 0, "{heard}");
        heard.push_str(&String::from_utf8_lossy(&buffer[..n]));
    }
    // There is no specimen: that is told, and nothing is run.
    assert!(heard.contains("event: begun") && heard.contains("no specimen yet"), "{heard}");
    Ok(())
}
