//! A SpaceMouse, through a test daemon that speaks the protocol.

use nalgebra::Vector3;
use std::io::Write;
use std::os::unix::net::{UnixListener, UnixStream};
use std::time::{Duration, Instant};
use touchoff::{Pose, Unit};
use touchoff_haptics::spacenav::{Spacenav, SpeedGains};
use touchoff_haptics::{Device, DeviceError};
use touchoff_tests::haptics::upright;

fn event(kind: i32, pushed: [i32; 6]) -> [u8; 32] {
    let mut bytes = [0; 32];
    let numbers = std::iter::once(kind).chain(pushed).chain([16]);
    for (bytes_of_number, number) in bytes.chunks_exact_mut(4).zip(numbers) {
        bytes_of_number.copy_from_slice(&number.to_ne_bytes());
    }
    bytes
}

const FLIGHT: SpeedGains = SpeedGains { linear: 100.0, angular: 1.0 };

fn opened(folder: &tempfile::TempDir) -> (UnixListener, UnixStream, Spacenav) {
    let socket = folder.path().join("spnav.sock");
    let listener = UnixListener::bind(&socket).expect("a socket");
    let device = Spacenav::open(&socket, upright(10.0), Unit::Millimetre, 1000.0, FLIGHT);
    let device = device.expect("a daemon");
    let (stream, _) = listener.accept().expect("a client");
    (listener, stream, device)
}

/// Polls the device until a condition holds, or two seconds are over.
fn until(
    device: &mut Spacenav,
    so: impl Fn(&Result<Pose, DeviceError>) -> bool,
) -> Result<Pose, DeviceError> {
    let start = Instant::now();
    loop {
        let result = device.pose();
        if so(&result) || start.elapsed() > Duration::from_secs(2) {
            return result;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn moves(device: &mut Spacenav) -> Vector3<f64> {
    let [before, after] = [0, 1].map(|_| device.pose().expect("a pose").tip());
    after - before
}

#[test]
fn cap_deflection_sets_the_tool_speed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_listener, mut stream, mut device) = opened(&folder);
    assert_eq!(device.pose().expect("a pose"), upright(10.0));
    // Sent in two pieces, with a button between two motions.
    let right = event(0, [350, 0, 0, 0, 0, 0]);
    stream.write_all(&right[..13]).expect("sent");
    stream.flush().expect("sent");
    stream.write_all(&right[13..]).expect("sent");
    stream.write_all(&event(1, [3, 0, 0, 0, 0, 0])).expect("sent");
    until(&mut device, |result| result.as_ref().is_ok_and(|pose| pose.tip().x > 0.0))
        .expect("a pose");
    assert!((moves(&mut device) - Vector3::new(0.1, 0.0, 0.0)).norm() < 1e-12);
    stream.write_all(&event(0, [0, 175, 0, 0, 0, 0])).expect("sent");
    let x = device.pose().expect("a pose").tip().z;
    until(&mut device, |result| result.as_ref().is_ok_and(|pose| pose.tip().z > x + 0.04))
        .expect("up");
    assert!((moves(&mut device) - Vector3::new(0.0, 0.0, 0.05)).norm() < 1e-12);
    // A released cap reports so; one that reports nothing counts as released.
    std::thread::sleep(Duration::from_millis(600));
    device.pose().expect("a pose");
    assert_eq!(moves(&mut device), Vector3::zeros());
}

#[test]
fn reconnects_to_a_daemon_that_was_restarted() {
    let folder = tempfile::tempdir().expect("a folder");
    let (listener, stream, mut device) = opened(&folder);
    drop(stream);
    let result = until(&mut device, Result::is_err);
    assert!(matches!(result, Err(DeviceError::NotResponding(_))), "{result:?}");
    let (mut stream, _) = listener.accept().expect("it calls again");
    until(&mut device, Result::is_ok).expect("it is there again");
    stream.write_all(&event(0, [0, 0, 350, 0, 0, 0])).expect("sent");
    let reconnected =
        until(&mut device, |result| result.as_ref().is_ok_and(|pose| pose.tip().y > 0.0));
    assert!(reconnected.expect("a pose").tip().y > 0.0);
}

#[test]
fn a_missing_daemon_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let nobody = folder.path().join("nobody.sock");
    assert!(Spacenav::open(&nobody, upright(10.0), Unit::Millimetre, 1000.0, FLIGHT).is_err());
}
