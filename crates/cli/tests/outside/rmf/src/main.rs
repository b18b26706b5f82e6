//! `rmf-check FILE`: reads a `.building.yaml` with Open-RMF's own crate, converts it to a site, and prints the
//! corners of its walls.

use std::error::Error;

use rmf_site_format::legacy::building_map::BuildingMap;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("a file is needed")?;
    let building = BuildingMap::from_bytes(&std::fs::read(file)?)?;
    let level = building.levels.get("L1").ok_or("no level L1")?;
    for wall in &level.walls {
        let corner = |k: usize| level.vertices.get(k).map(|v| (v.0, v.1)).ok_or("no such vertex");
        let ((x1, y1), (x2, y2)) = (corner(wall.0)?, corner(wall.1)?);
        println!("{x1:.4} {y1:.4} {x2:.4} {y2:.4}");
    }
    let site = building.to_site().map_err(|fault| format!("no site: {fault:?}"))?;
    let level = site.levels.values().next().ok_or("the site has no level")?;
    if level.walls.len() != building.levels["L1"].walls.len() {
        return Err("the site has other walls than the building".into());
    }
    Ok(())
}
