#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| lumel_fuzz::run("mtl", input));
