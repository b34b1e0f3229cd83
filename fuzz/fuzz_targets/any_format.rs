#![no_main]
geose_fmap_fuzz::target!("any_format");
