//! The calls of `SessionService`, each handed to its own file.

use std::sync::Arc;

use tonic::{Request, Response, Status};
use wire::v1 as pb;

use super::{Server, create_session, fork_session, session};

/// `SessionService`.
#[derive(Clone, Debug)]
pub(super) struct Sessions(pub(super) Arc<Server>);

#[tonic::async_trait]
impl pb::session_service_server::SessionService for Sessions {
    async fn create_session(
        &self,
        request: Request<pb::CreateSessionRequest>,
    ) -> Result<Response<pb::CreateSessionResponse>, Status> {
        create_session::answer(&self.0, request)
    }

    async fn fork_session(
        &self,
        request: Request<pb::ForkSessionRequest>,
    ) -> Result<Response<pb::ForkSessionResponse>, Status> {
        fork_session::answer(&self.0, request).await
    }

    async fn create_token(
        &self,
        request: Request<pb::CreateTokenRequest>,
    ) -> Result<Response<pb::CreateTokenResponse>, Status> {
        session::create_token(&self.0, request)
    }

    async fn get_session(
        &self,
        request: Request<pb::GetSessionRequest>,
    ) -> Result<Response<pb::GetSessionResponse>, Status> {
        session::get(&self.0, request)
    }

    async fn renew_session(
        &self,
        request: Request<pb::RenewSessionRequest>,
    ) -> Result<Response<pb::RenewSessionResponse>, Status> {
        session::renew(&self.0, request)
    }

    async fn list_sessions(
        &self,
        request: Request<pb::ListSessionsRequest>,
    ) -> Result<Response<pb::ListSessionsResponse>, Status> {
        session::list(&self.0, request)
    }

    async fn delete_session(
        &self,
        request: Request<pb::DeleteSessionRequest>,
    ) -> Result<Response<pb::DeleteSessionResponse>, Status> {
        session::delete(&self.0, request)
    }
}
