//! KTX2 pictures: what follows the first bytes of such a file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use parbake_files::decode_image;
use parbake_fuzz::LIMITS;

fuzz_target!(|data: &[u8]| {
    let file = [b"\xabKTX 20\xbb\r\n\x1a\n".as_slice(), data].concat();
    match decode_image("fuzz", &file, &LIMITS) {
        Ok(image) => assert_eq!(image.pixels.len(), image.width * image.height),
        Err(error) => assert!(error.to_string().starts_with("fuzz"), "{error}"),
    }
});
