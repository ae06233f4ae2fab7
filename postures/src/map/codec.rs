//! Encoding of values in the file: a CRC-32 of the rest, little-endian, then `postcard`.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Encodes a value.
pub(super) fn encode(value: &impl Serialize) -> Vec<u8> {
    let payload = postcard::to_allocvec(value).expect("lists of known length");
    let mut bytes = crc32fast::hash(&payload).to_le_bytes().to_vec();
    bytes.extend(payload);
    bytes
}

/// Decodes a value; `None` if the bytes are not those that were written.
pub(super) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let (checksum, payload) = bytes.split_first_chunk()?;
    if u32::from_le_bytes(*checksum) != crc32fast::hash(payload) {
        return None;
    }
    match postcard::take_from_bytes(payload) {
        Ok((value, [])) => Some(value),
        _ => None,
    }
}
