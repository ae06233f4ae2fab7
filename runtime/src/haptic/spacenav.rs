//! A SpaceMouse, by the protocol of `spacenavd`: a Unix socket that sends, for each event, eight 32-bit
//! integers of the machine's byte order: what it is (0 motion, 1 a button pressed, 2 released), how far the cap
//! is pushed along x (right), y (up) and z (away from the user) and turned about them, and the time since the
//! last event in ms.
//!
//! It pushes nobody: it is flown with, the cap's displacement being the tool's speed.

use super::frame::{Frame, join};
use super::setting;
use super::{Axes, Device, DeviceError, Limits, Push};
use crate::pose::Pose;
use crate::unit::Unit;
use nalgebra::{Point3, Vector3};
use std::io::{self, Read};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Where `spacenavd` listens.
pub const SOCKET: &str = "/run/spnav.sock";

/// How fast it flies with the cap pushed all the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// mm/s
    pub way: f64,
    /// rad/s
    pub turn: f64,
}

/// What the cap says when it is pushed all the way, about.
const FULL: f64 = 350.0;
/// A cap that is held says so again within this time.
const SILENT: Duration = Duration::from_millis(250);
/// So long after a daemon went away it is called again.
const AGAIN: Duration = Duration::from_millis(100);

/// What the cap does, as far as is known.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cap {
    Pushed([i32; 6]),
    Gone,
}

/// A SpaceMouse. Reading it is a thread's of its own, so that the loop never waits for it; a daemon that goes
/// away is called again until it is there.
pub struct Spacenav {
    cap: triple_buffer::Output<Cap>,
    pose: Pose,
    frame: Frame,
    period: f64,
    flight: Flight,
    reader: Option<JoinHandle<()>>,
    stop: Arc<AtomicBool>,
}

impl Spacenav {
    /// A device of so many cycles a second, with the tool at a pose to begin with, in the part's unit.
    ///
    /// # Errors
    /// If nobody listens at the socket; of kind [`InvalidInput`](io::ErrorKind::InvalidInput) and with a
    /// [`SettingError`](super::SettingError) inside if the rate or a speed is out of its range.
    pub fn open(
        socket: &Path,
        (start, unit): (Pose, Unit),
        (rate, flight): (f64, Flight),
    ) -> io::Result<Spacenav> {
        let wrong = |error| io::Error::new(io::ErrorKind::InvalidInput, error);
        let period = setting::period(rate).map_err(wrong)?;
        setting::above_zero("speed of flight in mm/s", flight.way).map_err(wrong)?;
        setting::above_zero("turning speed of flight in rad/s", flight.turn).map_err(wrong)?;
        let stream = connected(socket)?;
        let (news, cap) = triple_buffer::triple_buffer(&Cap::Pushed([0; 6]));
        let stop = Arc::new(AtomicBool::new(false));
        let reader = {
            let (socket, stop) = (socket.to_owned(), Arc::clone(&stop));
            std::thread::spawn(move || listen(stream, &socket, news, &stop))
        };
        let axes = if start.is_full() { Axes::Six } else { Axes::Five };
        let unit = unit.to(Unit::Millimetre);
        let frame = Frame { centre: Point3::origin(), unit, axes };
        Ok(Spacenav { cap, pose: start, frame, period, flight, reader: Some(reader), stop })
    }
}

fn connected(socket: &Path) -> io::Result<UnixStream> {
    let stream = UnixStream::connect(socket)?;
    stream.set_read_timeout(Some(SILENT))?;
    Ok(stream)
}

/// Reads events until it is told to stop.
fn listen(
    mut stream: UnixStream,
    socket: &Path,
    mut news: triple_buffer::Input<Cap>,
    stop: &AtomicBool,
) {
    let mut event = [0; 32];
    let mut have = 0;
    while !stop.load(Ordering::Relaxed) {
        match stream.read(&mut event[have..]) {
            Ok(more) if more > 0 => {
                have += more;
                if have == event.len() {
                    have = 0;
                    if let Some(pushed) = motion(&event) {
                        news.write(Cap::Pushed(pushed));
                    }
                }
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            // Nothing moves.
            Err(error)
                if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) =>
            {
                news.write(Cap::Pushed([0; 6]));
            }
            Ok(_) | Err(_) => {
                news.write(Cap::Gone);
                have = 0;
                std::thread::sleep(AGAIN);
                if let Ok(again) = connected(socket) {
                    stream = again;
                    news.write(Cap::Pushed([0; 6]));
                }
            }
        }
    }
}

/// How far the cap is pushed and turned, if the event says so.
fn motion(event: &[u8; 32]) -> Option<[i32; 6]> {
    let number = |at: usize| {
        let bytes = [0, 1, 2, 3].map(|k| event[4 * at + k]);
        i32::from_ne_bytes(bytes)
    };
    (number(0) == 0).then(|| [1, 2, 3, 4, 5, 6].map(number))
}

impl Device for Spacenav {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let [x, y, z, about_x, about_y, about_z] = match *self.cap.read() {
            Cap::Pushed(pushed) => pushed.map(|part| f64::from(part) / FULL),
            Cap::Gone => {
                let gone = io::Error::new(io::ErrorKind::NotConnected, "spacenavd went away");
                return Err(DeviceError::Gone(gone));
            }
        };
        // The world's z is up, its y away from the user. Of a turn about the cap's z the sign is the other one,
        // as everywhere that goes by this daemon: right, up and away are a left-handed frame.
        let way = Vector3::new(x, z, y) * (self.flight.way * self.period);
        let turn = Vector3::new(about_x, about_z, about_y) * (self.flight.turn * self.period);
        self.pose = self.frame.moved(&self.pose, &join(&way, &turn))?;
        Ok(self.pose)
    }

    fn push(&mut self, _: &Push) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> Limits {
        // It pushes nobody; what is shown to the eye is that of a small desktop device.
        Limits { axes: self.frame.axes, ..Limits::default() }
    }
}

impl Drop for Spacenav {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // It panics at nothing.
            let _ = reader.join();
        }
    }
}
