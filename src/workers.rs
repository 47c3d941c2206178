//! The threads that serve: each has connections of its own, which it reads from, whose calls it answers, and which it writes to.
//!
//! # Method
//! A runtime of one thread for each processor, which waits for the sockets of its connections itself. So a client's next question finds
//! the caches as its last one left them, and a call that gives way to others goes on where it was, for the price of a look at the
//! sockets. Where threads share sockets, the next turn of a call, and the next call of a client, go to whichever thread is awake:
//! nobody looks at the sockets while the one that did takes up a long call, and the others sleep until they are woken.
//!
//! Connections go to the threads in turn. A call that comes while another call is at work on its thread is answered on a thread where
//! none is, if there is one, so that a client with one connection has all processors.
//!
//! # Limits
//! An item of columns that takes long, which has no turns, keeps the connections of its thread waiting; single questions that do are
//! answered elsewhere ([`crate::rpc`]).

use std::{
    io,
    num::NonZero,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use tokio::{
    io::DuplexStream,
    net::TcpStream,
    runtime::{self, Handle},
    sync::{mpsc, oneshot},
    task::JoinError,
};
use tokio_stream::{Stream, StreamExt, wrappers::ReceiverStream};
use tokio_util::task::AbortOnDropHandle;

use crate::compute::Load;

/// Connections that wait for a thread to take them up.
const BACKLOG: usize = 64;

/// The threads.
#[derive(Debug)]
pub(crate) struct Workers {
    threads: Vec<Worker>,
    next: AtomicUsize,
}

#[derive(Debug)]
struct Worker {
    sockets: mpsc::Sender<std::net::TcpStream>,
    in_process: mpsc::Sender<DuplexStream>,
    runtime: Handle,
    load: Load,
}

/// The connections of a thread.
#[derive(Debug)]
pub(crate) struct Connections {
    sockets: mpsc::Receiver<std::net::TcpStream>,
    in_process: mpsc::Receiver<DuplexStream>,
}

/// What will be a thread when it is told what to serve.
#[derive(Debug)]
pub(crate) struct Idle {
    runtime: Runtime,
    connections: Connections,
    load: Load,
}

/// A runtime that may be dropped anywhere: what works in the background is not waited for.
#[derive(Debug)]
struct Runtime(Option<runtime::Runtime>);

impl Runtime {
    fn run(&self, work: impl Future<Output = ()>) {
        if let Some(runtime) = &self.0 {
            runtime.block_on(work);
        }
    }
}

impl Drop for Runtime {
    fn drop(&mut self) {
        if let Some(runtime) = self.0.take() {
            runtime.shutdown_background();
        }
    }
}

impl Workers {
    /// One for each processor.
    ///
    /// # Errors
    /// The system refuses what a runtime needs.
    pub(crate) fn new() -> io::Result<(Self, Vec<Idle>)> {
        let count = thread::available_parallelism().map_or(1, NonZero::get);
        let made: io::Result<Vec<(Worker, Idle)>> = (0..count).map(|_| Worker::new()).collect();
        let (threads, idle) = made?.into_iter().unzip();
        Ok((Self { threads, next: AtomicUsize::new(0) }, idle))
    }

    /// Takes up a connection from a socket.
    ///
    /// # Errors
    /// The socket cannot change its thread, or the threads have ended.
    pub(crate) async fn take_up(&self, socket: TcpStream) -> io::Result<()> {
        let taken = self.next().sockets.send(socket.into_std()?).await;
        taken.map_err(|_| stopped())
    }

    /// Takes up a connection within the process.
    ///
    /// # Errors
    /// The threads have ended.
    pub(crate) async fn take_up_in_process(&self, pipe: DuplexStream) -> io::Result<()> {
        self.next().in_process.send(pipe).await.map_err(|_| stopped())
    }

    fn next(&self) -> &Worker {
        &self.threads[self.next.fetch_add(1, Ordering::Relaxed) % self.threads.len()]
    }

    /// Answers a call here, or on a thread where no call is at work if one is here.
    ///
    /// # Errors
    /// It panicked there, or the server is stopping.
    pub(crate) async fn answer<T: Send + 'static>(
        &self,
        call: impl Future<Output = T> + Send + 'static,
    ) -> Result<T, JoinError> {
        let free = if Load::here().is_any() { self.threads.iter().find(|other| !other.load.is_any()) } else { None };
        match free {
            None => Ok(call.await),
            Some(other) => AbortOnDropHandle::new(other.runtime.spawn(call)).await,
        }
    }
}

impl Worker {
    fn new() -> io::Result<(Self, Idle)> {
        let (sockets, incoming) = mpsc::channel(BACKLOG);
        let (in_process, incoming_in_process) = mpsc::channel(BACKLOG);
        let runtime = runtime::Builder::new_current_thread().enable_all().build()?;
        let (handle, load) = (runtime.handle().clone(), Load::default());
        let connections = Connections { sockets: incoming, in_process: incoming_in_process };
        let idle = Idle { runtime: Runtime(Some(runtime)), connections, load: load.clone() };
        Ok((Self { sockets, in_process, runtime: handle, load }, idle))
    }
}

impl Idle {
    /// Begins the thread, which ends when what it serves does; what is returned is done then.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub(crate) fn begin<S: Future<Output = ()>>(
        self,
        number: usize,
        serve: impl FnOnce(Connections) -> S + Send + 'static,
    ) -> io::Result<impl Future<Output = ()>> {
        let Self { runtime, connections, load } = self;
        let (tell_end, ended) = oneshot::channel();
        thread::Builder::new().name(format!("serving-{number}")).spawn(move || {
            load.begin_here();
            runtime.run(serve(connections));
            drop(runtime);
            let _ = tell_end.send(());
        })?;
        Ok(async {
            // A thread that ended without a word has ended as well.
            let _ = ended.await;
        })
    }
}

impl Connections {
    /// Those from sockets, and those within the process.
    pub(crate) fn split(
        self,
    ) -> (impl Stream<Item = io::Result<TcpStream>>, impl Stream<Item = io::Result<DuplexStream>>) {
        let sockets = ReceiverStream::new(self.sockets).map(TcpStream::from_std);
        (sockets, ReceiverStream::new(self.in_process).map(Ok))
    }
}

fn stopped() -> io::Error {
    io::Error::new(io::ErrorKind::ConnectionRefused, "the server has stopped")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::AtWork;

    fn name() -> Option<String> {
        thread::current().name().map(ToOwned::to_owned)
    }

    /// As where a server does not start.
    #[tokio::test]
    async fn threads_that_never_begin_are_dropped_by_whoever_runs_in_a_runtime() {
        let (workers, idle) = Workers::new().unwrap();
        drop(idle);
        let socket = tokio::io::duplex(1).0;
        assert_eq!(workers.take_up_in_process(socket).await.unwrap_err().kind(), io::ErrorKind::ConnectionRefused);
    }

    #[tokio::test]
    async fn a_call_beside_another_is_answered_on_a_free_thread() {
        let (workers, idle) = Workers::new().unwrap();
        let (end, told) = tokio::sync::watch::channel(());
        let begin = |(number, thread): (usize, Idle)| {
            let mut told = told.clone();
            thread.begin(number, |_| async move {
                let _ = told.changed().await;
            })
        };
        let ends: Vec<_> = idle.into_iter().enumerate().map(|thread| begin(thread).unwrap()).collect();
        let here = name();
        assert_eq!(workers.answer(async { name() }).await.unwrap(), here, "nobody is at work here");
        let at_work = AtWork::begin();
        assert_eq!(workers.answer(async { name() }).await.unwrap().as_deref(), Some("serving-0"));
        assert!(workers.answer(async { panic!("on purpose") }).await.unwrap_err().is_panic());
        let on_each: Vec<AtWork> = workers.threads.iter().map(|thread| thread.load.at_work()).collect();
        assert_eq!(workers.answer(async { name() }).await.unwrap(), here, "all have a call at work");
        drop((at_work, on_each));
        assert_eq!(workers.answer(async { name() }).await.unwrap(), here);
        drop(end);
        for end in ends {
            end.await;
        }
    }
}
