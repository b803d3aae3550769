//! Listening on 127.0.0.1.

use crate::BenchError;
use crate::bench::Bench;
use crate::guard::Gate;
use crate::routes::{App, router};

use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Between two looks at whether the user wants to stop.
const PACE: Duration = Duration::from_millis(50);
/// Between two signs of life to listening pages.
const BEAT: Duration = Duration::from_secs(15);
/// How long a search that is stopped with the server may take to keep its best.
const FAREWELL: Duration = Duration::from_secs(20);

/// A workbench that listens.
pub struct Server {
    app: App,
    listener: TcpListener,
}

impl Server {
    /// Listens on 127.0.0.1; port 0 is any free one. The token is made anew.
    ///
    /// # Errors
    /// If the port is taken, or the system has no random numbers.
    pub fn bind(bench: Bench, port: u16) -> Result<Self, BenchError> {
        let failed = |source| BenchError::Listen { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let port = listener.local_addr().map_err(failed)?.port();
        let mut random = [0_u8; 32];
        getrandom::fill(&mut random)
            .map_err(|e| BenchError::Asked(format!("the system gives no random numbers: {e}")))?;
        let token = random.iter().map(|b| format!("{b:02x}")).collect();
        let app = App { bench: Arc::new(bench), gate: Arc::new(Gate { port, token }) };
        Ok(Self { app, listener })
    }

    /// The address to open, with the token.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.app.gate.port, self.app.gate.token)
    }

    /// Serves until `stops`; a search that then runs keeps its best.
    ///
    /// # Errors
    /// If the system refuses threads.
    pub fn run(self, stops: &dyn Fn() -> bool) -> Result<(), BenchError> {
        let port = self.app.gate.port;
        let failed = |source| BenchError::Listen { port, source };
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .max_blocking_threads(8)
            .build()
            .map_err(failed)?;
        let bench = self.app.bench.clone();
        let worker =
            std::thread::Builder::new().name("worker".into()).spawn(move || bench.work()).map_err(failed)?;
        let bench = self.app.bench.clone();
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            tokio::spawn(axum::serve(listener, router(self.app)).into_future());
            let mut beaten = Instant::now();
            while !stops() {
                tokio::time::sleep(PACE).await;
                if beaten.elapsed() >= BEAT {
                    bench.hub.beat();
                    beaten = Instant::now();
                }
            }
            Ok(())
        });
        bench.queue.close();
        let begun = Instant::now();
        while !worker.is_finished() && begun.elapsed() < FAREWELL {
            std::thread::sleep(PACE);
        }
        runtime.shutdown_background();
        served.map_err(failed)
    }
}
