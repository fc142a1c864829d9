//! Looking into the running program: what is on its screen, by texts, and pictures of it.

use eframe::egui::accesskit::{NodeId, Toggled};
use egui_inspection::protocol::{Request, Response, read_handshake, read_message, write_message};
use std::collections::HashMap;
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// An address on the loopback interface that nobody listens on.
pub(crate) fn free_address() -> String {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string()
}

/// Something on the screen.
pub(crate) struct Node {
    pub(crate) text: String,
    pub(crate) number: Option<f64>,
    pub(crate) is_on: bool,
    pub(crate) center: [f64; 2],
}

/// The connection to the program.
pub(crate) struct Peer(TcpStream);

impl Peer {
    pub(crate) fn connect(address: &str) -> Self {
        let begun = Instant::now();
        loop {
            if let Ok(mut stream) = TcpStream::connect(address)
                && read_handshake(&mut stream).is_ok()
            {
                stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
                return Self(stream);
            }
            assert!(begun.elapsed() < Duration::from_secs(60), "the program does not answer on {address}");
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn ask(&mut self, request: Request) -> Response {
        write_message(&mut self.0, &request).unwrap();
        read_message(&mut self.0).unwrap()
    }

    /// All that is on the screen and has a text.
    pub(crate) fn nodes(&mut self) -> Vec<Node> {
        let response = self.ask(Request::GetTree);
        let Response::Tree { accesskit: Some(tree), .. } = response else { return Vec::new() };
        let labels: HashMap<NodeId, String> = tree
            .nodes
            .iter()
            .filter_map(|(id, node)| Some((*id, node.label().or(node.value())?.to_owned())))
            .collect();
        let text = |node: &eframe::egui::accesskit::Node| {
            let own = node.label().or(node.value()).map(str::to_owned);
            own.or_else(|| node.labelled_by().first().and_then(|id| labels.get(id).cloned()))
                .unwrap_or_default()
        };
        let node = |(_, node): &(NodeId, eframe::egui::accesskit::Node)| {
            let bounds = node.bounds()?;
            Some(Node {
                text: text(node),
                number: node.numeric_value(),
                is_on: node.toggled() == Some(Toggled::True) || node.is_selected() == Some(true),
                center: [(bounds.x0 + bounds.x1) / 2.0, (bounds.y0 + bounds.y1) / 2.0],
            })
        };
        tree.nodes.iter().filter_map(node).collect()
    }

    /// What the window shows.
    pub(crate) fn screenshot(&mut self) -> Shot {
        match self.ask(Request::GetScreenshot { pixels_per_point: Some(1.0) }) {
            Response::Screenshot(png) => Shot(image::load_from_memory(&png.bytes).unwrap().to_rgb8()),
            other => panic!("no screenshot: {other:?}"),
        }
    }
}

/// A picture of the window.
pub(crate) struct Shot(image::RgbImage);

impl Shot {
    /// Keeps the picture where a failed test is looked into.
    pub(crate) fn keep(&self, name: &str) {
        let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
        self.0.save(folder.join(name)).unwrap();
    }

    fn area(&self, at: [u32; 2], size: [u32; 2]) -> impl Iterator<Item = [f64; 3]> + '_ {
        let pixels =
            (at[1]..at[1] + size[1]).flat_map(move |y| (at[0]..at[0] + size[0]).map(move |x| (x, y)));
        pixels.map(|(x, y)| self.0.get_pixel(x, y).0.map(f64::from))
    }

    /// Mean of each channel over a part, 0..=255.
    pub(crate) fn mean(&self, at: [u32; 2], size: [u32; 2]) -> [f64; 3] {
        let n = f64::from(size[0] * size[1]);
        let sum = self.area(at, size).fold([0.0; 3], |sum, p| [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]);
        sum.map(|s| s / n)
    }

    /// Mean difference of the channels over a part.
    pub(crate) fn difference(&self, other: &Self, at: [u32; 2], size: [u32; 2]) -> f64 {
        let pairs = self.area(at, size).zip(other.area(at, size));
        let sum: f64 = pairs.map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()).sum::<f64>()).sum();
        sum / f64::from(3 * size[0] * size[1])
    }
}
