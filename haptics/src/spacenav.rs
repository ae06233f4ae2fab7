//! A SpaceMouse, by the protocol of `spacenavd`.
//!
//! The daemon's Unix socket sends eight 32-bit integers in the machine's byte order per event. The first is the kind of
//! event: 0 motion, 1 button pressed, 2 button released. Then follow the displacements of the cap along x (right), y
//! (up) and z (away from the user), the rotations about these axes, and the time since the last event in ms.
//!
//! The device applies no force. It controls speed: the cap's displacement sets the tool's velocity.

use super::frame::{Frame, join};
use super::setting::{self, SettingError, above_zero};
use super::{Device, DeviceAxes, DeviceError, DeviceLimits, DeviceWrench};
use nalgebra::{Point3, Vector3};
use std::fmt;
use std::io::{self, Read};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;
use touchoff::{Pose, Unit};

/// The socket of `spacenavd`.
pub const SOCKET: &str = "/run/spnav.sock";

/// Speeds at full displacement of the cap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedGains {
    /// Linear speed, mm/s.
    pub linear: f64,
    /// Angular speed, rad/s.
    pub angular: f64,
}

impl SpeedGains {
    fn check(&self) -> Result<(), SettingError> {
        above_zero("linear speed at full displacement, in mm/s", self.linear)?;
        above_zero("angular speed at full displacement, in rad/s", self.angular)
    }
}

/// Approximate reading at full displacement of the cap.
const FULL_DISPLACEMENT: f64 = 350.0;
/// Longest time between events while the cap is held.
const EVENT_TIMEOUT: Duration = Duration::from_millis(250);
/// Time between attempts to reconnect to the daemon.
const RECONNECT_INTERVAL: Duration = Duration::from_millis(100);

/// The last known state of the cap.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cap {
    Displaced([i32; 6]),
    Disconnected,
}

/// A SpaceMouse. A separate thread reads it, so that the loop never waits. If the daemon goes away, the
/// thread reconnects until it is back.
pub struct Spacenav {
    cap: triple_buffer::Output<Cap>,
    pose: Pose,
    frame: Frame,
    period: f64,
    gains: SpeedGains,
    reader: Option<JoinHandle<()>>,
    stop: Arc<AtomicBool>,
}

impl fmt::Debug for Spacenav {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Spacenav")
            .field("pose", &self.pose)
            .field("period", &self.period)
            .field("gains", &self.gains)
            .finish_non_exhaustive()
    }
}

impl Spacenav {
    /// Creates a device of `rate` cycles per second, with the tool initially at the pose `start`, in the
    /// part's unit `unit`.
    ///
    /// # Errors
    /// Fails if nothing listens at the socket. Fails with [`InvalidInput`](io::ErrorKind::InvalidInput),
    /// with a [`SettingError`] inside, if the rate or a speed is out of its range.
    pub fn open(
        socket: &Path,
        start: Pose,
        unit: Unit,
        rate: f64,
        gains: SpeedGains,
    ) -> io::Result<Spacenav> {
        let period = setting::period(rate)
            .and_then(|period| gains.check().map(|()| period))
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        let stream = connect(socket)?;
        // The last state counts, not every event: the reader never waits for the loop, nor the loop for it.
        let (publisher, cap) = triple_buffer::triple_buffer(&Cap::Displaced([0; 6]));
        let stop = Arc::new(AtomicBool::new(false));
        let reader = {
            let (socket, stop) = (socket.to_owned(), Arc::clone(&stop));
            std::thread::spawn(move || listen(stream, &socket, publisher, &stop))
        };
        let axes = if start.has_spin() { DeviceAxes::Six } else { DeviceAxes::Five };
        let unit = unit.factor_to(Unit::Millimetre);
        let frame = Frame { centre: Point3::origin(), unit, axes };
        Ok(Spacenav { cap, pose: start, frame, period, gains, reader: Some(reader), stop })
    }
}

fn connect(socket: &Path) -> io::Result<UnixStream> {
    let stream = UnixStream::connect(socket)?;
    stream.set_read_timeout(Some(EVENT_TIMEOUT))?;
    Ok(stream)
}

/// Reads events until `stop` is set.
fn listen(
    mut stream: UnixStream,
    socket: &Path,
    mut publisher: triple_buffer::Input<Cap>,
    stop: &AtomicBool,
) {
    let mut event = [0; 32];
    let mut received = 0;
    while !stop.load(Ordering::Relaxed) {
        match stream.read(&mut event[received..]) {
            Ok(more) if more > 0 => {
                // A read may end within an event.
                received += more;
                if received == event.len() {
                    received = 0;
                    if let Some(pushed) = motion(&event) {
                        publisher.write(Cap::Displaced(pushed));
                    }
                }
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            // No event within the timeout: the cap is at rest.
            Err(error)
                if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) =>
            {
                publisher.write(Cap::Displaced([0; 6]));
            }
            Ok(_) | Err(_) => {
                publisher.write(Cap::Disconnected);
                received = 0;
                std::thread::sleep(RECONNECT_INTERVAL);
                if let Ok(reconnected) = connect(socket) {
                    stream = reconnected;
                    publisher.write(Cap::Displaced([0; 6]));
                }
            }
        }
    }
}

/// Returns the displacements and rotations of the cap if the event is a motion.
fn motion(event: &[u8; 32]) -> Option<[i32; 6]> {
    let (words, _) = event.as_chunks::<4>();
    let is_motion = i32::from_ne_bytes(words[0]) == 0;
    is_motion.then(|| [1, 2, 3, 4, 5, 6].map(|at| i32::from_ne_bytes(words[at])))
}

impl Device for Spacenav {
    fn pose(&mut self) -> Result<Pose, DeviceError> {
        let [x, y, z, about_x, about_y, about_z] = match *self.cap.read() {
            Cap::Displaced(pushed) => pushed.map(|part| f64::from(part) / FULL_DISPLACEMENT),
            Cap::Disconnected => {
                let gone = io::Error::new(io::ErrorKind::NotConnected, "spacenavd went away");
                return Err(DeviceError::NotResponding(gone));
            }
        };
        // World z is up and y points away from the user. Right, up and away form a left-handed frame,
        // but the daemon and all its clients use the opposite sign for turns about the cap's z.
        let translation = Vector3::new(x, z, y) * (self.gains.linear * self.period);
        let rotation = Vector3::new(about_x, about_z, about_y) * (self.gains.angular * self.period);
        self.pose = self.frame.moved(&self.pose, &join(&translation, &rotation))?;
        Ok(self.pose)
    }

    fn apply(&mut self, _: &DeviceWrench) -> Result<(), DeviceError> {
        Ok(())
    }

    fn limits(&self) -> DeviceLimits {
        // The device applies no force; for display it has the limits of a small desktop device.
        DeviceLimits { axes: self.frame.axes, ..DeviceLimits::default() }
    }
}

impl Drop for Spacenav {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // The thread does not panic.
            let _ = reader.join();
        }
    }
}
