//! `UpdateWorld`: other settings of a world.

use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Caller, Server};
use crate::{
    compute::{self, Weight},
    convert::settings::{changed, settings_out},
    problem::Under,
    token::Role,
};

/// Changes the settings that are named.
///
/// # Errors
/// A number out of range; the world is in quarantine.
pub(super) async fn answer(
    server: &Server,
    request: Request<pb::UpdateWorldRequest>,
) -> Result<Response<pb::UpdateWorldResponse>, Status> {
    let caller = Caller::of(&request);
    let sent = request.into_inner();
    let session = server.enter(&caller, &sent.session, Role::Writer)?;
    let mut writer = session.writer.clone().lock_owned().await;
    // Another may have changed them meanwhile: only under the lock are they those that stay.
    let settings = changed(writer.world.settings(), sent.settings.as_ref()).under("settings")?;
    let set = move || session.set(&mut writer, settings);
    compute::run(Weight::Light, "changing settings", set).await?;
    Ok(Response::new(pb::UpdateWorldResponse { settings: Some(settings_out(settings)) }))
}
